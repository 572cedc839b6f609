// Frames of the volume that is being received, from their arrival to what pass 1 converts.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hw/probe/polar_volume.h"
#include "render/options.h"
#include "render/reconstruction/motor_angles.h"

namespace wobblebench::render {

/// A sample clamped to [0, 1], 0 for NaN and infinities, so that a bad sample affects its
/// neighbourhood only.
inline float clean_sample(float sample) {
  // On the bit patterns, which order as the positive floats do, so that the loop is vectorised:
  // negative values, infinity and NaN lie above the largest finite float.
  const auto bits = std::bit_cast<std::uint32_t>(sample);
  const bool is_valid = bits <= std::bit_cast<std::uint32_t>(std::numeric_limits<float>::max());
  return std::bit_cast<float>(is_valid ? std::min(bits, std::bit_cast<std::uint32_t>(1.0f)) : 0u);
}

/// Throws std::invalid_argument for linear envelopes: thresholds and transfer function are those of
/// log-compressed samples.
void check_log_compressed(const hw::PolarVolume& volume);

/// A frame ([line * samples_per_stick + sample]) in a sum of frames.
struct WeightedFrame {
  const std::vector<float>* samples = nullptr;
  float share = 0;
};

/// Keeps each frame as it arrives, with clean_sample() and without gaps: a lost stick is the mean
/// of the nearest sticks of its frame on both sides that arrived, weighted by their distance. A
/// frame of which no stick arrived is zero.
///
/// Pass 1 converts these frames or, with Sticks::aligned and where motor angles leave the plan,
/// those that put_aligned() gives. It reads them through taps(): the part of the 3D kernel that
/// lies across frames. Filtering sticks equals filtering slices, as scan conversion is linear and
/// the same for all frames, and sticks are fewer than pixels.
///
/// Tracks which layers of the volume texture a frame changes, and which of them are complete: all
/// frames that contribute to them have arrived since begin_volume(). Layer k holds slice k, in mode
/// fast slices k and k + 1.
class FrameStore {
 public:
  FrameStore(const hw::AcquisitionPlan& plan, const RenderOptions& options);

  /// Throws std::out_of_range for an index outside the plan, std::invalid_argument for a frame of
  /// another size.
  void put(int index, const hw::PolarFrame& frame);
  /// All frames of dense_plan(), of the volume that has arrived.
  void put_aligned(std::vector<std::vector<float>> frames);
  /// The memory of those frames, to make others in; put_aligned() has to follow.
  std::vector<std::vector<float>> take_aligned() { return std::exchange(aligned_, {}); }
  /// From now on received() is converted, which Sticks::aligned does not allow.
  void drop_aligned();

  /// Whether all frames have arrived since begin_volume().
  bool volume_complete() const;
  void begin_volume();

  /// [frame][line * samples_per_stick + sample] of the scan; zeros before a frame's arrival.
  const std::vector<std::vector<float>>& received() const { return received_; }
  /// The motor angles of received().
  MotorAngles angles() const { return angles_.angles(); }

  /// Changed layers that are complete, ascending; they count as unchanged from then on.
  [[nodiscard]] std::vector<int> take_complete();
  /// All changed layers, likewise.
  [[nodiscard]] std::vector<int> take_changed();

  /// The frames whose weighted sum its slice is made from: the filter across frames.
  std::vector<WeightedFrame> taps(int slice) const;
  /// That sum.
  std::vector<float> filtered(int slice) const;

 private:
  void fill_lost_sticks(const std::vector<std::uint8_t>& arrived,
                        std::vector<float>& samples) const;
  const std::vector<std::vector<float>>& converted() const;
  int first_neighbour(int slice) const;
  int last_neighbour(int slice) const;
  bool is_complete(int layer) const;

  std::size_t lines_, samples_;  ///< of a frame, of a stick
  int slices_per_layer_;
  std::vector<double> weights_;  ///< frame_weights()
  int half_;                     ///< of the weights
  std::vector<std::vector<float>> received_;
  ReceivedAngles angles_;
  std::vector<std::vector<float>> aligned_;  ///< empty: received_ is converted
  std::size_t to_convert_ = 0;               ///< number of frames that pass 1 converts
  std::vector<bool> arrived_;                ///< per frame
  std::vector<bool> changed_;                ///< per layer
};

}  // namespace wobblebench::render
