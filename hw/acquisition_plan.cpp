#include "hw/acquisition_plan.h"

#include <cmath>

#include "hw/options.h"

namespace wobblebench::hw {
namespace {

/// Angle of item `index` of `count` spread evenly over `span`, both ends included.
double spread(int index, int count, double span_rad) {
  return count < 2 ? 0.0 : span_rad * (static_cast<double>(index) / (count - 1) - 0.5);
}

double step(int count, double span_rad) {
  return count < 2 ? 0.0 : span_rad / (count - 1);
}

}  // namespace

AcquisitionPlan::AcquisitionPlan(const ProbeOptions& probe, const AcquisitionOptions& acquisition)
    : probe_(probe), acquisition_(acquisition) {
  validate(probe_);
  check_options(acquisition_);
}

std::uint64_t AcquisitionPlan::sequence(const StickIndex& index) const {
  const auto frames = static_cast<std::uint64_t>(acquisition_.frames_per_volume);
  const auto lines = static_cast<std::uint64_t>(acquisition_.sticks_per_frame);
  return (index.volume * frames + index.frame) * lines + index.line;
}

StickIndex AcquisitionPlan::index(std::uint64_t sequence) const {
  const auto frames = static_cast<std::uint64_t>(acquisition_.frames_per_volume);
  const auto lines = static_cast<std::uint64_t>(acquisition_.sticks_per_frame);
  const std::uint64_t frame = sequence / lines;
  return {static_cast<std::uint32_t>(frame / frames),
          static_cast<std::uint32_t>(frame % frames),
          static_cast<std::uint32_t>(sequence % lines)};
}

double AcquisitionPlan::stick_period_s() const {
  return 2 * acquisition_.depth_m / acquisition_.sound_speed_m_s + acquisition_.dead_time_s;
}

DeviceTime AcquisitionPlan::stick_time(std::uint64_t sequence) const {
  // In extended precision the rounding of a period does not show, whatever the sequence number.
  const long double count = sequence;
  const long double echo_ns =
      count * 2e9L * acquisition_.depth_m / static_cast<long double>(acquisition_.sound_speed_m_s);
  const long double nanoseconds = std::round(echo_ns + count * 1e9L * acquisition_.dead_time_s);
  constexpr auto kEnd = DeviceDuration::max();
  if (nanoseconds >= static_cast<long double>(kEnd.count())) return DeviceTime(kEnd);
  return DeviceTime(DeviceDuration(static_cast<DeviceClock::rep>(nanoseconds)));
}

DeviceDuration AcquisitionPlan::volume_duration() const {
  return stick_time(static_cast<std::uint64_t>(sticks_per_volume())).time_since_epoch();
}

double AcquisitionPlan::theta_rad(int line) const {
  return spread(line, acquisition_.sticks_per_frame, acquisition_.sector_rad);
}

double AcquisitionPlan::frame_phi_rad(int frame) const {
  return spread(frame, acquisition_.frames_per_volume, acquisition_.fan_rad);
}

double AcquisitionPlan::motor_angle_rad(const StickIndex& index) const {
  const double frame_phi = frame_phi_rad(static_cast<int>(index.frame));
  if (acquisition_.motor == MotorMode::stepped) return frame_phi;
  const double through_frame = (index.line + 0.5) / acquisition_.sticks_per_frame;
  return frame_phi + phi_step_rad() * (through_frame - 0.5);
}

double AcquisitionPlan::theta_step_rad() const {
  return step(acquisition_.sticks_per_frame, acquisition_.sector_rad);
}

double AcquisitionPlan::phi_step_rad() const {
  return step(acquisition_.frames_per_volume, acquisition_.fan_rad);
}

}  // namespace wobblebench::hw
