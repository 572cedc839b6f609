// From the frames of a volume to those that pass 1 converts, with the levels of their echoes.
#pragma once

#include <utility>
#include <vector>

#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "render/reconstruction/aligned_sticks.h"
#include "render/reconstruction/echo_levels.h"
#include "render/reconstruction/received_frames.h"

namespace wobblebench::render {

/// Whether any setting needs the levels of fluid and tissue.
bool needs_levels(const RenderOptions& options);

/// What a sample, or with Detector::floor its rise, must reach at a surface; infinite without two
/// kinds of echoes.
double detection_level(const EchoLevels& levels, const RayCastingOptions& options);

/// Frames made by ReconstructionOptions, the same in both modes of the pipeline.
class Reconstruction {
 public:
  Reconstruction(const hw::AcquisitionPlan& plan, const RenderOptions& options);

  /// A frame of the scan; throws as ReceivedFrames::put().
  void put(int index, const hw::PolarFrame& frame) { received_.put(index, frame); }
  /// Whether all frames of the scan have arrived since begin_volume().
  bool volume_complete() const { return received_.volume_complete(); }
  void begin_volume() { received_.begin_volume(); }

  bool aligns() const { return options_.reconstruction.sticks == Sticks::aligned; }
  /// The scan's frame, cleaned: what pass 1 converts without alignment.
  const std::vector<float>& frame(int index) const {
    return received_.frames().at(static_cast<std::size_t>(index));
  }
  /// Of the frames that have arrived.
  EchoLevels levels() const;
  /// All frames of the denser scan.
  std::vector<std::vector<float>> aligned_frames(const EchoLevels& levels) const;

 private:
  hw::AcquisitionPlan plan_;
  RenderOptions options_;
  std::vector<SampleSpan> spans_;
  ReceivedFrames received_;
};

}  // namespace wobblebench::render
