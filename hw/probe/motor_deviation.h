// By how much the motor angles that sticks tell leave those of the plan.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>

#include "hw/probe/polar_volume.h"

namespace wobblebench::hw {

/// Deviations up to this one count as none: 2 % of the angle between frames (of the fan, where
/// there is one frame), and no less than 1e-6 rad.
double negligible_deviation_rad(const AcquisitionPlan& plan);

/// Least and greatest motor angle of the plan's first volume.
std::pair<double, double> planned_fan_rad(const AcquisitionPlan& plan);

/// Of sticks of one plan. A motor that accelerates, has an offset or a backlash is not where the
/// plan has it.
struct MotorDeviation {
  std::uint64_t sticks = 0;
  double max_rad = 0;
  double sum_rad2 = 0;  ///< of the squares
  /// Least and greatest motor angle of all sticks.
  double low_rad = std::numeric_limits<double>::infinity();
  double high_rad = -std::numeric_limits<double>::infinity();

  void add(const AcquisitionPlan& plan, const StickIndex& index, double motor_angle_rad);
  void add(const MotorDeviation& other);
  double rms_rad() const;
  bool matters(const AcquisitionPlan& plan) const {
    return max_rad > negligible_deviation_rad(plan);
  }
};

/// Of the volume's sticks that arrived.
MotorDeviation motor_deviation(const PolarVolume& volume);

}  // namespace wobblebench::hw
