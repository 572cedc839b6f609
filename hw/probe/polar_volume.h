// Sticks put in their places: polar frames and the volume that they make.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/stick.h"

namespace wobblebench::hw {

/// One image plane: sticks_per_frame x samples_per_stick samples, stick after stick.
struct PolarFrame {
  std::vector<float> samples;           ///< [line * samples_per_stick + sample]
  std::vector<std::uint8_t> arrived;    ///< per line; a lost line holds zeros
  std::vector<double> motor_angle_rad;  ///< per line; the plan's angle where the line is lost
};

/// All frames of one volume. A lost stick stays zero and is marked, never filled with old data.
class PolarVolume {
 public:
  /// Empty. `volume` is its index in the stream, from 0.
  explicit PolarVolume(const AcquisitionPlan& plan, std::uint32_t volume = 0);

  /// Puts a stick in its place, whichever turn it had. Throws std::out_of_range for an index
  /// outside the plan, which the board does not let through, or of another volume;
  /// std::invalid_argument for a wrong number of samples.
  void place(const Stick& stick);

  const AcquisitionPlan& plan() const { return plan_; }
  const std::vector<PolarFrame>& frames() const { return frames_; }
  const PolarFrame& frame(int index) const { return frames_.at(static_cast<std::size_t>(index)); }
  int missing_sticks() const;
  SampleScale scale() const { return scale_; }
  /// Which volume of the stream this is.
  std::uint32_t volume_index() const { return volume_index_; }

 private:
  AcquisitionPlan plan_;
  std::vector<PolarFrame> frames_;
  SampleScale scale_ = SampleScale::log_compressed;
  std::uint32_t volume_index_;
};

}  // namespace wobblebench::hw
