// The frames of the volume on its way to the slices.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::render {

/// Keeps each frame as it came, cleaned, and gives it mixed with its neighbours by the part of the
/// 3D kernel that lies across frames. Mixing sticks is mixing slices, as all frames are converted
/// alike, and sticks are fewer than pixels.
///
/// Tells which layers of the volume texture a frame changes, and which of them are settled: those
/// whose every contributing frame has arrived since begin_volume(). Layer k holds slice k, or
/// slices k and k + 1.
class FrameStore {
 public:
  /// `weights`: see frame_weights().
  FrameStore(const hw::AcquisitionPlan& plan,
             const std::vector<double>& weights,
             int slices_per_layer);

  /// Throws std::out_of_range for an index outside the plan, std::invalid_argument for a frame of
  /// another size.
  void put(int index, const hw::PolarFrame& frame);

  /// Changed layers that are settled, ascending; they count as unchanged from then on.
  std::vector<int> take_settled();
  /// All changed layers.
  std::vector<int> take_changed();

  /// Whether each frame has arrived since begin_volume().
  bool volume_complete() const;
  void begin_volume();

  /// What the frame's slice is made from; valid until the next call.
  const std::vector<float>& mixed(int index);

 private:
  int first_neighbour(int slice) const;
  int last_neighbour(int slice) const;
  bool settled(int layer) const;

  int frames_, half_, slices_per_layer_;
  std::vector<double> weights_;
  std::size_t samples_;  ///< of a frame
  std::vector<std::vector<float>> clean_;
  std::vector<bool> arrived_;  ///< per frame
  std::vector<bool> changed_;  ///< per layer
  std::vector<float> mixed_;
};

/// What pass 1 makes of a sample before anything else: within [0, 1], 0 for NaN and infinities, so
/// that a bad sample reaches no further than its own neighbourhood.
float clean_sample(float sample);

}  // namespace wobblebench::render
