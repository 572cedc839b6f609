#include "hw/probe/motor_deviation.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::hw {

double negligible_deviation_rad(const AcquisitionPlan& plan) {
  constexpr double kShare = 0.02, kRounding_rad = 1e-6;
  const double step_rad = plan.phi_step_rad();
  return std::max(kShare * (step_rad > 0 ? step_rad : plan.acquisition().fan_rad), kRounding_rad);
}

std::pair<double, double> planned_fan_rad(const AcquisitionPlan& plan) {
  const auto last_frame = static_cast<std::uint32_t>(plan.acquisition().frames_per_volume - 1);
  const auto last_line = static_cast<std::uint32_t>(plan.acquisition().sticks_per_frame - 1);
  return {plan.motor_angle_rad({0, 0, 0}), plan.motor_angle_rad({0, last_frame, last_line})};
}

void MotorDeviation::add(const AcquisitionPlan& plan,
                         const StickIndex& index,
                         double motor_angle_rad) {
  const double deviation_rad = std::abs(motor_angle_rad - plan.motor_angle_rad(index));
  ++sticks;
  max_rad = std::max(max_rad, deviation_rad);
  sum_rad2 += deviation_rad * deviation_rad;
  low_rad = std::min(low_rad, motor_angle_rad);
  high_rad = std::max(high_rad, motor_angle_rad);
}

void MotorDeviation::add(const MotorDeviation& other) {
  sticks += other.sticks;
  max_rad = std::max(max_rad, other.max_rad);
  sum_rad2 += other.sum_rad2;
  low_rad = std::min(low_rad, other.low_rad);
  high_rad = std::max(high_rad, other.high_rad);
}

MotorDeviation motor_deviation(const PolarVolume& volume) {
  MotorDeviation motor;
  StickIndex index{volume.volume_index(), 0, 0};
  for (const PolarFrame& frame : volume.frames()) {
    for (index.line = 0; index.line < frame.arrived.size(); ++index.line) {
      if (frame.arrived[index.line] == 0) continue;
      motor.add(volume.plan(), index, frame.motor_angle_rad[index.line]);
    }
    ++index.frame;
  }
  return motor;
}

double MotorDeviation::rms_rad() const {
  return sticks == 0 ? 0 : std::sqrt(sum_rad2 / static_cast<double>(sticks));
}

}  // namespace wobblebench::hw
