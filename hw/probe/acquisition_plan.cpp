#include "hw/probe/acquisition_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/options.h"
#include "hw/probe/beam_width.h"

namespace wobblebench::hw {
namespace {

/// Angle of item `index` of `count` at equal spacing over `span_rad`, both ends included.
double angle_of(int index, int count, double span_rad) {
  return count < 2 ? 0.0 : span_rad * (static_cast<double>(index) / (count - 1) - 0.5);
}

double angle_step(int count, double span_rad) {
  return count < 2 ? 0.0 : span_rad / (count - 1);
}

/// Inverse of angle_of(), rounded to the nearest item.
std::uint32_t nearest_item(double angle_rad, int count, double span_rad) {
  if (count < 2) return 0;
  const double index = std::round((angle_rad / span_rad + 0.5) * (count - 1));
  return static_cast<std::uint32_t>(std::clamp(index, 0.0, count - 1.0));
}

double echo_time_s(const AcquisitionOptions& acquisition) {
  return 2 * acquisition.depth_m / acquisition.sound_speed_m_s;
}

}  // namespace

AcquisitionOptions with_one_zone(AcquisitionOptions acquisition) {
  acquisition.dead_time_s += (acquisition.focal_zones - 1) * echo_time_s(acquisition);
  acquisition.focal_zones = 1;
  return acquisition;
}

AcquisitionPlan::AcquisitionPlan(const ProbeOptions& probe, const AcquisitionOptions& acquisition)
    : probe_(probe), acquisition_(acquisition) {
  validate_known(probe_);
  check_options(acquisition_);
  if (acquisition_.focal_zones == 1) return;
  try {
    check_options(with_one_zone(acquisition_));
  } catch (const InvalidOption&) {
    throw InvalidOption("focal_zones",
                        std::to_string(acquisition_.focal_zones),
                        "at most 10 ms a stick in all zones but one, dead time included");
  }
}

int AcquisitionPlan::sweep_direction(std::uint32_t volume) const {
  return acquisition_.motor == MotorMode::alternating && volume % 2 == 1 ? -1 : 1;
}

std::uint64_t AcquisitionPlan::first_sequence(std::uint32_t volume) const {
  return volume * static_cast<std::uint64_t>(sticks_per_volume());
}

std::uint64_t AcquisitionPlan::sequence(const StickIndex& index) const {
  const auto frames = static_cast<std::uint64_t>(acquisition_.frames_per_volume);
  const auto lines = static_cast<std::uint64_t>(acquisition_.sticks_per_frame);
  if (index.frame >= frames || index.line >= lines) {
    throw std::out_of_range("frame " + std::to_string(index.frame) + ", line " +
                            std::to_string(index.line) + " of a plan of " + std::to_string(frames) +
                            " frames of " + std::to_string(lines) + " sticks");
  }
  const bool back = sweep_direction(index.volume) < 0;
  const std::uint64_t order = back ? frames - 1 - index.frame : index.frame;
  return (index.volume * frames + order) * lines + index.line;
}

bool AcquisitionPlan::has_stick(std::uint64_t sequence) const {
  return sequence / static_cast<std::uint64_t>(sticks_per_volume()) <=
         std::numeric_limits<std::uint32_t>::max();
}

StickIndex AcquisitionPlan::index(std::uint64_t sequence) const {
  if (!has_stick(sequence)) {
    throw std::out_of_range("stick " + std::to_string(sequence) +
                            ": its volume has no number below 2^32");
  }
  const auto frames = static_cast<std::uint64_t>(acquisition_.frames_per_volume);
  const auto lines = static_cast<std::uint64_t>(acquisition_.sticks_per_frame);
  const auto volume = static_cast<std::uint32_t>(sequence / lines / frames);
  const std::uint64_t order = sequence / lines % frames;
  const bool back = sweep_direction(volume) < 0;
  return {volume,
          static_cast<std::uint32_t>(back ? frames - 1 - order : order),
          static_cast<std::uint32_t>(sequence % lines)};
}

StickIndex AcquisitionPlan::nearest_stick(const PolarPoint& point, std::uint32_t volume) const {
  return {volume,
          nearest_item(point.phi_rad, acquisition_.frames_per_volume, acquisition_.fan_rad),
          nearest_item(point.theta_rad, acquisition_.sticks_per_frame, acquisition_.sector_rad)};
}

double AcquisitionPlan::stick_period_s() const {
  return acquisition_.focal_zones * echo_time_s(acquisition_) + acquisition_.dead_time_s;
}

DeviceTime AcquisitionPlan::time_after(std::uint64_t sticks, std::uint64_t fly_backs) const {
  // Extended precision: the rounding of a period stays below 1 ns at any sequence number.
  const long double count = sticks;
  const long double echo_ns = count * acquisition_.focal_zones * 2e9L * acquisition_.depth_m /
                              static_cast<long double>(acquisition_.sound_speed_m_s);
  const long double dead_ns = count * 1e9L * acquisition_.dead_time_s;
  const bool returns = acquisition_.motor == MotorMode::fly_back;
  const long double fly_back_ns =
      returns ? static_cast<long double>(fly_backs) * 1e9L * acquisition_.fly_back_s : 0;
  const long double nanoseconds = std::round(echo_ns + dead_ns + fly_back_ns);
  constexpr auto kEnd = DeviceDuration::max();
  if (nanoseconds >= static_cast<long double>(kEnd.count())) return DeviceTime(kEnd);
  return DeviceTime(DeviceDuration(static_cast<DeviceClock::rep>(nanoseconds)));
}

DeviceTime AcquisitionPlan::stick_time(std::uint64_t sequence) const {
  return time_after(sequence, sequence / static_cast<std::uint64_t>(sticks_per_volume()));
}

DeviceTime AcquisitionPlan::volume_end_time(std::uint32_t volume) const {
  return time_after(first_sequence(volume) + static_cast<std::uint64_t>(sticks_per_volume()),
                    volume);
}

DeviceDuration AcquisitionPlan::volume_duration() const {
  return stick_time(static_cast<std::uint64_t>(sticks_per_volume())).time_since_epoch();
}

double AcquisitionPlan::theta_rad(int line) const {
  return angle_of(line, acquisition_.sticks_per_frame, acquisition_.sector_rad);
}

double AcquisitionPlan::frame_phi_rad(int frame) const {
  return angle_of(frame, acquisition_.frames_per_volume, acquisition_.fan_rad);
}

double AcquisitionPlan::motor_angle_rad(const StickIndex& index) const {
  const double frame_phi = frame_phi_rad(static_cast<int>(index.frame));
  if (acquisition_.motor == MotorMode::stepped) return frame_phi;
  const double from_centre = (index.line + 0.5) / acquisition_.sticks_per_frame - 0.5;
  return frame_phi + sweep_direction(index.volume) * phi_step_rad() * from_centre;
}

double AcquisitionPlan::theta_step_rad() const {
  return angle_step(acquisition_.sticks_per_frame, acquisition_.sector_rad);
}

double AcquisitionPlan::phi_step_rad() const {
  return angle_step(acquisition_.frames_per_volume, acquisition_.fan_rad);
}

}  // namespace wobblebench::hw
