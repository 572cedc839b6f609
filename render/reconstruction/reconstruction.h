// From the frames of a volume to those that pass 1 converts, with the levels of their echoes.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"
#include "render/reconstruction/aligned_sticks.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::render {

/// Whether any setting needs the levels of fluid and tissue.
bool needs_levels(const RenderOptions& options);

/// What a sample, or with Detector::floor its rise, must reach at a surface; infinite without two
/// kinds of echoes.
double detection_level(const EchoLevels& levels, const RayCastingOptions& options);

/// What ReconstructionOptions ask for before pass 1, the same in both modes of the pipeline.
class Reconstruction {
 public:
  Reconstruction(const hw::AcquisitionPlan& plan, const RenderOptions& options);

  bool aligns() const { return options_.reconstruction.sticks == Sticks::aligned; }
  /// `received`: FrameStore::received(); `angles`: FrameStore::angles().
  EchoLevels levels(const std::vector<std::vector<float>>& received,
                    const MotorAngles& angles) const;
  /// All frames of dense_plan(), for FrameStore::put_aligned().
  std::vector<std::vector<float>> aligned_frames(const std::vector<std::vector<float>>& received,
                                                 const MotorAngles& angles,
                                                 const EchoLevels& levels) const;

 private:
  std::vector<SampleSpan> spans(const MotorAngles& angles) const;

  hw::AcquisitionPlan plan_;
  RenderOptions options_;
  std::vector<SampleSpan> planned_spans_;
};

}  // namespace wobblebench::render
