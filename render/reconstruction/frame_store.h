// CPU storage of the frames of the volume that is being received, and their filter across frames.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::render {

/// Stores each frame, of samples in [0, 1], and filters it with its neighbours
/// by the part of the 3D kernel that lies across frames. Filtering sticks equals filtering slices,
/// as scan conversion is linear and the same for all frames, and sticks are fewer than pixels.
///
/// Tracks which layers of the volume texture a frame changes, and which of them are complete: all
/// frames that contribute to them have arrived since begin_volume(). Layer k holds slice k, or
/// slices k and k + 1.
class FrameStore {
 public:
  /// `weights`: see frame_weights().
  FrameStore(const hw::AcquisitionPlan& plan,
             const std::vector<double>& weights,
             int slices_per_layer);

  /// Throws std::out_of_range for an index outside the plan, std::invalid_argument for a frame of
  /// another size.
  void put(int index, std::vector<float> samples);

  /// Changed layers that are complete, ascending; they count as unchanged from then on.
  [[nodiscard]] std::vector<int> take_complete();
  /// All changed layers, likewise.
  [[nodiscard]] std::vector<int> take_changed();

  /// Whether all frames have arrived since begin_volume().
  bool volume_complete() const;
  void begin_volume();

  /// The frame filtered across frames, from which its slice is made; valid until the next call.
  const std::vector<float>& filtered(int index);

 private:
  int first_neighbour(int slice) const;
  int last_neighbour(int slice) const;
  bool is_complete(int layer) const;

  int frames_, half_, slices_per_layer_;
  std::vector<double> weights_;
  std::size_t samples_;  ///< of a frame
  std::vector<std::vector<float>> clean_;
  std::vector<bool> arrived_;  ///< per frame
  std::vector<bool> changed_;  ///< per layer
  std::vector<float> filtered_;
};

}  // namespace wobblebench::render
