// Sticks, and the polar frames and volumes that they are placed in.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

/// Scale of a stick's samples.
enum class SampleScale : std::uint8_t {
  log_compressed = 0,  ///< [0, 1] over the dynamic range
  linear_envelope = 1,
};

/// One stick (scan line): the detected samples along one beam axis, as the board delivers them.
struct Stick {
  std::uint64_t sequence = 0;  ///< counts the sticks of the stream from 0
  StickIndex index;
  DeviceTime time{};
  double motor_angle_rad = 0;
  int sweep_direction = 1;  ///< +1: phi grows over the volume, -1: it falls
  SampleScale scale = SampleScale::log_compressed;
  bool checked = true;         ///< false: the source sent no CRC, damage would not be detected
  std::vector<float> samples;  ///< [samples_per_stick], nearest range first
};

/// Sets number, index, time, motor angle and sweep direction to those of the plan. Throws as
/// AcquisitionPlan::index().
void schedule(Stick& stick, const AcquisitionPlan& plan, std::uint64_t sequence);

/// One image plane, sticks_per_frame x samples_per_stick samples.
struct PolarFrame {
  std::vector<float> samples;           ///< [line * samples_per_stick + sample]
  std::vector<std::uint8_t> arrived;    ///< [line]; 0: lost, its samples are zero
  std::vector<double> motor_angle_rad;  ///< [line]; the plan's where lost
};

/// All frames of one volume. The samples of a lost stick are zero, and it is marked as lost.
///
/// @code
/// const hw::AcquisitionPlan plan({}, {});
/// hw::PolarVolume volume(plan);
/// hw::Stick stick;
/// stick.samples.resize(static_cast<std::size_t>(plan.acquisition().samples_per_stick));
/// volume.place(stick);
/// if (volume.missing_sticks() == plan.sticks_per_volume() - 1) return;
/// @endcode
class PolarVolume {
 public:
  /// All sticks missing. `volume` is the index in the stream, from 0.
  explicit PolarVolume(const AcquisitionPlan& plan, std::uint32_t volume = 0);

  /// All sticks, of their samples: stick after stick in the order of firing.
  static PolarVolume of_samples(const AcquisitionPlan& plan,
                                std::uint32_t volume,
                                SampleScale scale,
                                std::span<const float> samples);

  /// Copies the stick to its frame and line, in any order. Throws std::out_of_range for an index
  /// outside the plan (which the board rejects before) or of another volume, std::invalid_argument
  /// for a wrong number of samples.
  void place(const Stick& stick);
  /// Copies those lines of a frame of another volume that arrived in it. Throws std::out_of_range
  /// and std::invalid_argument where the plan has another number of lines or samples.
  void place_frame(int frame, const PolarFrame& from, SampleScale scale);

  const AcquisitionPlan& plan() const { return plan_; }
  const std::vector<PolarFrame>& frames() const { return frames_; }
  const PolarFrame& frame(int index) const { return frames_.at(static_cast<std::size_t>(index)); }
  /// Maps linear envelopes, 1 at full scale, to [0, 1] over the dynamic range below it, as the
  /// scanner's log compression does: 1 + 20 log10(sample) / range. Leaves log-compressed samples,
  /// NaN and infinities alone.
  void log_compress(double dynamic_range_db);

  int missing_sticks() const;
  SampleScale scale() const { return scale_; }
  /// Index in the stream, from 0.
  std::uint32_t volume_index() const { return volume_index_; }

 private:
  void place_line(const StickIndex& index,
                  std::span<const float> samples,
                  double motor_angle_rad,
                  SampleScale scale);

  AcquisitionPlan plan_;
  std::vector<PolarFrame> frames_;
  SampleScale scale_ = SampleScale::log_compressed;
  std::uint32_t volume_index_;
};

}  // namespace wobblebench::hw
