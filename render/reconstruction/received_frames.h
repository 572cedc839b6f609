// The frames of a volume as they arrive, cleaned, without gaps.
#pragma once

#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::render {

/// Samples in [0, 1] (clean_sample()). A lost stick is the mean of the nearest sticks of its frame
/// on both sides that arrived, weighted by their distance; it has no weight of its own. A frame of
/// which no stick arrived is empty.
class ReceivedFrames {
 public:
  explicit ReceivedFrames(const hw::AcquisitionPlan& plan);

  /// Throws std::out_of_range for an index outside the plan, std::invalid_argument for a frame of
  /// another size.
  void put(int index, const hw::PolarFrame& frame);

  /// Whether all frames have arrived since begin_volume().
  bool volume_complete() const;
  void begin_volume();

  /// [frame][line * samples_per_stick + sample]; zeros before a frame's arrival.
  const std::vector<std::vector<float>>& frames() const { return frames_; }

 private:
  void fill_lost_sticks(const std::vector<std::uint8_t>& arrived,
                        std::vector<float>& samples) const;

  std::size_t lines_, samples_;  ///< of a frame, of a stick
  std::vector<std::vector<float>> frames_;
  std::vector<bool> arrived_;  ///< per frame
};

}  // namespace wobblebench::render
