#include "bench/exchange/input/described_file.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "base/number_text.h"
#include "bench/exchange/files/foreign_names.h"
#include "bench/exchange/files/kretz.h"
#include "bench/exchange/files/meta_image.h"
#include "bench/exchange/files/nrrd.h"
#include "bench/exchange/files/zea.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

VoxelFile raw_file(const fs::path& path, const Described& described) {
  described.need("element", "the type of the voxels");
  described.need("sizes", "the number of voxels along each axis, fastest first");
  const Geometry& geometry = described.geometry;
  std::ostringstream sizes;
  for (const double size : geometry.sizes) sizes << size << " ";
  VoxelFile file{.path = path,
                 .data_path = path,
                 .offset = static_cast<std::uint64_t>(geometry.offset_bytes),
                 .element = geometry.element,
                 .big_endian = geometry.big_endian};
  file.sizes = sizes_in(path, "geometry.sizes", sizes.str());
  if (element_bytes(file.element) > 1) {
    described.need("big_endian", "the order of their bytes, true or false");
  }
  check_size(file);
  return file;
}

/// Keys of raw voxels, which the headers of other formats say.
void refuse_raw_keys(const Described& described) {
  for (const char* key : {"element", "sizes", "big_endian", "offset_bytes"}) {
    if (!described.geometry.has(key)) continue;
    described.refuse("geometry." + std::string(key) + ": acts with raw voxels (.raw, .img); " +
                     described.file.path.string() + " says it itself");
  }
}

/// What the file says of the scan; the rest is of the geometry file.
void add_kretz_geometry(const KretzScan& kretz, Described& described) {
  Geometry& geometry = described.geometry;
  for (const char* key : {"layout",
                          "radius_mm",
                          "wobble_radius_mm",
                          "sector_deg",
                          "fan_deg",
                          "motor_angles_deg",
                          "depth_mm",
                          "frames_per_volume",
                          "axes"}) {
    if (geometry.has(key)) {
      described.refuse("geometry." + std::string(key) + ": must not be given; " +
                       kretz.file.path.string() + " says it itself");
    }
    geometry.given.insert(key);
  }
  geometry.given.erase("fan_deg");
  const double half_rad = 0.5 * (kretz.line_rad.back() - kretz.line_rad.front());
  for (std::size_t i = 0; i < kretz.line_rad.size(); ++i) {
    const double share =
        kretz.line_rad.size() == 1
            ? 0.5
            : static_cast<double>(i) / static_cast<double>(kretz.line_rad.size() - 1);
    if (std::abs(kretz.line_rad[i] - (2 * share - 1) * half_rad) < 1e-3 * std::abs(half_rad) + 1e-9)
      continue;
    throw UserError(kretz.file.path.string() + ": line " + std::to_string(i) + " lies at " +
                    significant(kretz.line_rad[i] / kDegree, 4) +
                    " deg; lines must have equal angles between them, around the middle");
  }
  geometry.layout = Layout::polar;
  geometry.probe.radius_m = kretz.first_m - 0.5 * kretz.resolution_m;
  geometry.probe.wobble_radius_m = geometry.probe.radius_m - kretz.axis_m;
  geometry.sector_rad = 2 * half_rad;
  geometry.depth_m = kretz.resolution_m * static_cast<double>(kretz.file.sizes[0]);
  geometry.motor_angles_rad = kretz.frame_rad;
}

/// Axes and values as zea has them, where the geometry does not say them.
void add_zea_geometry(const ZeaPicture& zea, Described& described) {
  Geometry& geometry = described.geometry;
  described.coordinates_m = zea.coordinates_m;
  if (!geometry.has("axes")) {
    const bool has_y = zea.file.sizes.size() == 4;
    using Names = std::vector<std::string>;
    geometry.axes = geometry.layout == Layout::polar    ? Names{"line", "sample"}
                    : geometry.layout == Layout::planes ? Names{"column", "row"}
                                                        : Names{"x", "z"};
    const std::string third = geometry.layout == Layout::cartesian ? "y" : "frame";
    geometry.axes.insert(has_y ? geometry.axes.begin() : geometry.axes.end(), third);
    if (has_y) geometry.axes.emplace_back("volume");
  }
  if (zea.is_envelope && !geometry.has("values")) geometry.values = ValueScale::linear;
  if (zea.is_envelope || zea.file.element == Element::uint8) return;
  if (!geometry.has("white")) geometry.white = 0;
  if (!geometry.has("black")) {
    described.need("dynamic_range_db", "how many dB lie between black and white");
  }
  if (!geometry.has("black")) geometry.black = geometry.white - geometry.dynamic_range_db;
  geometry.given.insert({"white", "black"});
}

/// Axes and their directions as PLUS names them: F or N, a letter of the axis of depth, away from
/// the face or towards it; M or U, of the axis across, towards the marked side or away from it.
void add_orientation(Described& described) {
  const auto found = described.file.fields.find("UltrasoundImageOrientation");
  Geometry& geometry = described.geometry;
  if (found == described.file.fields.end() || geometry.layout == Layout::cartesian) return;
  const std::string said =
      described.file.path.string() + ": " + found->first + " = " + found->second;
  const bool is_polar = geometry.layout == Layout::polar;
  std::vector<std::string> axes, reversed;
  for (const char any : found->second.substr(0, 2)) {
    const char letter = static_cast<char>(any & ~0x20);  // in upper case
    const bool is_depth = letter == 'F' || letter == 'N';
    if (!is_depth && letter != 'M' && letter != 'U') {
      throw UserError(said + ": must be F or N and M or U");
    }
    axes.emplace_back(is_depth ? (is_polar ? "sample" : "row") : (is_polar ? "line" : "column"));
    if (letter == 'N' || letter == 'U') reversed.push_back(axes.back());
  }
  axes.emplace_back("frame");
  if (described.file.sizes.size() > 3) axes.emplace_back("volume");
  axes.resize(std::min(axes.size(), described.file.sizes.size()));
  if (std::ranges::count(geometry.reversed, "frame") > 0) reversed.emplace_back("frame");
  if (geometry.has("axes") && geometry.axes != axes) {
    described.refuse("geometry.axes: is not what the file says; " + said);
  }
  if (geometry.has("reversed") && !std::ranges::is_permutation(geometry.reversed, reversed)) {
    described.refuse("geometry.reversed: is not what the file says; " + said);
  }
  geometry.axes = axes;
  geometry.reversed = reversed;
}

/// Of a file that the geometry file describes, or else its own fields.
void add_geometry(Described& described, const fs::path& geometry) {
  refuse_raw_keys(described);
  if (!geometry.empty()) return;
  if (!is_of_export(described.file)) {
    throw UserError(described.file.path.string() +
                    ": does not say how it was scanned; must be given with geometry=FILE.toml");
  }
  described.geometry = geometry_of_fields(described.file.path, described.file.fields);
}

}  // namespace

bool is_of_export(const VoxelFile& file) {
  return file.fields.contains("wobblebench_content");
}

Described describe_file(const fs::path& path, const fs::path& geometry) {
  Described described{.file = {},
                      .geometry = {},
                      .geometry_source = geometry.empty() ? path.string() : geometry.string()};
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    throw UserError(path.string() + ": " +
                    (fs::exists(path, error) ? "is no file" : "no such file"));
  }
  if (!geometry.empty()) described.geometry = read_geometry(geometry);
  const ForeignFormat format = foreign_format(path);
  if (format == ForeignFormat::raw) {
    if (geometry.empty()) {
      throw UserError(path.string() + ": raw voxels need a geometry file: geometry=FILE.toml");
    }
    described.file = raw_file(path, described);
    return described;
  }
  if (format >= ForeignFormat::exr) {
    throw UserError(path.string() + ": holds no scan that is read (" +
                    (format == ForeignFormat::dicom
                         ? "DICOM: pydicom and viewers read it"
                         : "a picture, or arrays: numpy.load reads those") +
                    "); must be a recording or " + kForeignNames);
  }
  if (format == ForeignFormat::kretz) {
    const KretzScan kretz = read_kretz(path);
    described.file = kretz.file;
    refuse_raw_keys(described);
    add_kretz_geometry(kretz, described);
    return described;
  }
  std::optional<ZeaPicture> zea;
  if (format == ForeignFormat::zea) zea = read_zea(path);
  described.file = zea                             ? zea->file
                   : format == ForeignFormat::nrrd ? read_nrrd(path)
                                                   : read_meta_image(path);
  add_geometry(described, geometry);
  if (format == ForeignFormat::meta_image) add_orientation(described);
  if (zea) add_zea_geometry(*zea, described);
  return described;
}

Described describe_voxels(VoxelFile file, const fs::path& geometry) {
  Described described{.file = std::move(file), .geometry = {}, .geometry_source = {}};
  described.geometry_source = geometry.empty() ? described.file.path.string() : geometry.string();
  if (!geometry.empty()) described.geometry = read_geometry(geometry);
  add_geometry(described, geometry);
  return described;
}

}  // namespace wobblebench::bench
