// What is exported, whatever the format: volumes of a scan, what is known of them, and the writers.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/options.h"
#include "base/units.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/scene/resolved_scene.h"
#include "hw/probe/polar_volume.h"
#include "hw/wire/configuration.h"
#include "render/picture.h"
#include "render/renderer.h"
#include "sim/probe_simulator.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

/// What of a scan a file is to hold.
enum class Content {
  usual,       ///< what the format is usually used for
  everything,  ///< the polar volume with all that is known of it
  polar,       ///< samples by frame, line and sample
  cartesian,   ///< samples on a grid of equal spacing
  planes,      ///< each frame as a picture with equal spacing
  labels,      ///< materials on a grid of equal spacing
  parts,       ///< parts of the phantom on such a grid (docs/labels.md)
  found,       ///< the surface that the renderer found
  truth,       ///< the true surface
  slices,      ///< what pass 1 of the renderer makes of the last volume
};

enum class SampleType { usual, u8, u16, f32 };

/// Of one exported file, beside its name.
struct FileOptions {
  Content content = Content::usual;
  SampleType type = SampleType::usual;
  double spacing_m = 0.5e-3;  ///< of grids and planes
};

template <OptionsOf<FileOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.choice("content",
           o.content,
           {{"usual", Content::usual},
            {"everything", Content::everything},
            {"polar", Content::polar},
            {"cartesian", Content::cartesian},
            {"planes", Content::planes},
            {"labels", Content::labels},
            {"parts", Content::parts},
            {"found", Content::found},
            {"truth", Content::truth},
            {"slices", Content::slices}});
  v.choice("type",
           o.type,
           {{"usual", SampleType::usual},
            {"uint8", SampleType::u8},
            {"uint16", SampleType::u16},
            {"float", SampleType::f32}});
  v.real("spacing_mm", o.spacing_m, kMillimetre, 0.01, 10);
}

/// Materials at any position at any time, where the scanned subject is known.
class TissueLabels {
 public:
  /// The scene's subject must be known.
  TissueLabels(const ResolvedScene& scene, const sim::TissueMapSource& maps);

  const std::vector<std::string>& names() const { return names_; }
  /// Index of names() at a position in the probe frame, at the time of the stick that images it.
  std::uint8_t at(const glm::dvec3& position_m, std::uint32_t volume) const;
  std::uint8_t at_time(const glm::dvec3& position_m, double time_s) const;

  const phantoms::PlacedPhantom& subject() const { return subject_; }
  /// What is there at rest, at the time of the stick that images the position.
  glm::dvec3 to_rest(const glm::dvec3& position_m, std::uint32_t volume) const;

 private:
  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  phantoms::PlacedPhantom subject_;
  std::shared_ptr<const sim::TissueMap> map_;
  std::vector<std::string> names_;
};

/// What is known before the first volume comes.
struct ExportedScan {
  const ResolvedScene& scene;
  hw::DisplayScale display_scale;  ///< unstated where the stream does not state it
  bool simulated = true;
  bool knows_times = true;  ///< of its sticks
  std::uint32_t volumes = 1;
  std::optional<TissueLabels> labels;  ///< none: the subject is not known

  const hw::AcquisitionPlan& plan() const { return scene.plan(); }
  /// Geometry, scale and origin as keys and values, as a geometry file has them
  /// (docs/exchange.md).
  std::vector<std::pair<std::string, std::string>> fields() const;
};

/// The picture of the last volume, the slices that it was made of where a file holds them, and the
/// truth about it where that is known.
struct ExportedPicture {
  render::Picture picture;
  render::VolumeSlices slices;
  std::optional<Truth> truth;
};

/// Writes one file. Volumes come in their order, so that none need be kept.
class ScanWriter {
 public:
  virtual ~ScanWriter() = default;
  virtual void add(const hw::PolarVolume& volume) = 0;
  /// `picture`: null where none was asked for.
  virtual void finish(const ExportedPicture* picture) = 0;
};

/// Seconds from the first exported stick to the middle of a frame, and to the begin of a volume, by
/// the plan. Only of a scan that knows its times.
double frame_time_s(const hw::AcquisitionPlan& plan,
                    std::uint32_t first_volume,
                    std::uint32_t volume,
                    int frame);
double volume_time_s(const hw::AcquisitionPlan& plan,
                     std::uint32_t first_volume,
                     std::uint32_t volume);

/// Mean motor angle of a frame's sticks.
double mean_motor_angle_rad(const hw::PolarFrame& frame);

}  // namespace wobblebench::bench
