// From the frames of a volume to those that pass 1 converts, with the levels of their echoes.
#pragma once

#include <utility>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/beam_width.h"
#include "render/options.h"
#include "render/reconstruction/aligned_sticks.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::render {

/// Whether any setting needs the levels of fluid and tissue.
bool needs_levels(const RenderOptions& options);

/// What a sample, or with Detector::floor its rise, must reach at a surface; infinite without two
/// kinds of echoes.
double detection_level(const EchoLevels& levels, const RayCastingOptions& options);

/// The sticks of a volume before those between them are made.
struct PreparedSticks {
  std::vector<double> edges;                 ///< find_stick_edges()
  std::vector<std::vector<float>> levelled;  ///< level_sticks(); empty: the samples as they came
  std::pair<double, double> range;  ///< lowest and highest level of a stick, where `levelled`

  const std::vector<std::vector<float>>& samples(
      const std::vector<std::vector<float>>& received) const {
    return levelled.empty() ? received : levelled;
  }
};

/// `beam`: needed where has_stick_levels().
PreparedSticks prepare_sticks(const hw::AcquisitionPlan& plan,
                              const std::vector<std::vector<float>>& received,
                              const std::vector<SampleSpan>& spans,
                              const EchoLevels& levels,
                              const hw::BeamWidths* beam,
                              const RenderOptions& options);

/// What ReconstructionOptions and an automatic level ask for before pass 1, the same in both modes
/// of the pipeline.
class Reconstruction {
 public:
  Reconstruction(const hw::AcquisitionPlan& plan, const RenderOptions& options);

  bool waits_for_volume() const { return aligns() || has_stick_levels(options_); }
  /// Whether pass 1 converts other frames than were received.
  bool makes_frames(const MotorAngles& angles) const {
    return waits_for_volume() || !angles.as_planned();
  }
  /// `received`: FrameStore::received(); `angles`: FrameStore::angles().
  EchoLevels levels(const std::vector<std::vector<float>>& received,
                    const MotorAngles& angles) const;
  /// `levels`: where needs_levels(); `beam`: where has_stick_levels().
  PreparedSticks prepare(const std::vector<std::vector<float>>& received,
                         const MotorAngles& angles,
                         const EchoLevels& levels,
                         const hw::BeamWidths* beam) const;
  /// All frames of dense_plan(), for FrameStore::put_aligned(). `memory`: as align_sticks().
  std::vector<std::vector<float>> frames(const std::vector<std::vector<float>>& received,
                                         const MotorAngles& angles,
                                         const PreparedSticks& sticks,
                                         std::vector<std::vector<float>> memory) const;

 private:
  bool aligns() const { return options_.reconstruction.sticks == Sticks::aligned; }
  std::vector<SampleSpan> spans(const MotorAngles& angles) const;

  hw::AcquisitionPlan plan_;
  RenderOptions options_;
  std::vector<SampleSpan> planned_spans_;
};

}  // namespace wobblebench::render
