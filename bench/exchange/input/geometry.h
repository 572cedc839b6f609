// What a file of voxels does not say of the scan that it holds: given in TOML (docs/exchange.md).
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/units.h"
#include "bench/exchange/files/voxel_file.h"
#include "hw/probe/probe.h"

namespace wobblebench::bench {

enum class Layout {
  polar,     ///< sticks: samples by line and frame
  planes,    ///< each frame scan-converted: pixels of equal spacing
  cartesian  ///< a grid of equal spacing in space
};

/// How values stand for echoes.
enum class ValueScale {
  log,    ///< equal steps in dB
  linear  ///< envelope amplitude
};

struct Geometry {
  Layout layout = Layout::polar;
  hw::NamedProbeOptions probe;  ///< its face, and its aperture if that is given
  double sector_rad = 77 * kDegree;
  double fan_rad = 61 * kDegree;
  std::vector<double> motor_angles_rad;  ///< of each frame, in the place of fan_rad
  double depth_m = 0.16;
  int frames_per_volume = 0;  ///< 0: the frame axis is one volume
  double black = 0;           ///< value that becomes sample 0
  double white = 255;         ///< value that becomes sample 1
  ValueScale values = ValueScale::log;
  double dynamic_range_db = 60;  ///< from black to white; of linear values, below white
  double full_scale_db = 0;      ///< echo against a perfect mirror that is white
  double tgc_db_per_cm_mhz = 0;
  Element element = Element::uint8;  ///< of raw voxels, as those that follow
  bool big_endian = false;
  std::vector<double> sizes;  ///< fastest axis first
  int offset_bytes = 0;
  std::vector<std::string> axes;      ///< names, fastest first
  std::vector<std::string> reversed;  ///< of axes
  std::vector<double> spacing_m;      ///< of pixels or voxels, along each axis
  std::vector<double> center_px;      ///< planes: column and row of the centre of curvature
  /// Sticks that are made of a plane or a grid; 0: as many as its pixels give.
  int lines = 0;
  int samples = 0;
  int frames = 0;               ///< likewise, of a grid
  std::set<std::string> given;  ///< keys

  bool has(const std::string& key) const { return given.contains(key); }
};

template <OptionsOf<Geometry> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice(
      "layout",
      o.layout,
      {{"polar", Layout::polar}, {"planes", Layout::planes}, {"cartesian", Layout::cartesian}});
  describe(o.probe, v);
  v.real("sector_deg", o.sector_rad, kDegree, 0.1, 170);
  v.real("fan_deg", o.fan_rad, kDegree, 0.1, 170);
  v.reals("motor_angles_deg", o.motor_angles_rad, kDegree, -85, 85);
  v.real("depth_mm", o.depth_m, kMillimetre, 1, 400);
  v.integer("frames_per_volume", o.frames_per_volume, 0, 1024);
  v.real("black", o.black, 1, -1e9, 1e9);
  v.real("white", o.white, 1, -1e9, 1e9);
  v.choice("values", o.values, {{"log", ValueScale::log}, {"linear", ValueScale::linear}});
  v.real("dynamic_range_db", o.dynamic_range_db, 1, 10, 200);
  v.real("full_scale_db", o.full_scale_db, 1, -100, 20);
  v.real("tgc_db_per_cm_mhz", o.tgc_db_per_cm_mhz, 1, 0, 3);
  v.choice("element",
           o.element,
           {{"int8", Element::int8},
            {"uint8", Element::uint8},
            {"int16", Element::int16},
            {"uint16", Element::uint16},
            {"int32", Element::int32},
            {"uint32", Element::uint32},
            {"float32", Element::float32},
            {"float64", Element::float64}});
  v.flag("big_endian", o.big_endian);
  v.reals("sizes", o.sizes, 1, 1, 1e6);
  v.integer("offset_bytes", o.offset_bytes, 0, 1 << 30);
  v.texts("axes", o.axes);
  v.texts("reversed", o.reversed);
  v.reals("spacing_mm", o.spacing_m, kMillimetre, 1e-3, 100);
  v.reals("center_px", o.center_px, 1, -1e5, 1e5);
  v.integer("lines", o.lines, 0, 1024);
  v.integer("samples", o.samples, 0, 4096);
  v.integer("frames", o.frames, 0, 1024);
}

/// Reads [geometry] of a TOML file. Throws UserError "PATH: geometry.KEY = VALUE: what is allowed".
Geometry read_geometry(const std::filesystem::path& path);

/// The geometry that a file of `wobblebench export` tells by its fields "wobblebench_KEY"; keys
/// that it does not have are not given. Throws UserError.
Geometry geometry_of_fields(const std::filesystem::path& path, const HeaderFields& fields);

}  // namespace wobblebench::bench
