// When and where each stick of a volume looks.
#pragma once

#include <cstdint>

#include "hw/clock.h"
#include "hw/probe.h"

namespace wobblebench::hw {

enum class MotorMode {
  stepped,     ///< the motor rests at one angle while a frame is taken (the paper's assumption)
  continuous,  ///< the motor turns evenly through the frame; each stick has its own angle
};

/// What is acquired. Defaults: the paper's reference settings.
struct AcquisitionOptions {
  double depth_m = 0.16;  ///< longest range from the face
  double sector_rad = 77 * kDegree;
  double fan_rad = 61 * kDegree;
  int sticks_per_frame = 64;
  int samples_per_stick = 512;
  int frames_per_volume = 37;
  int volumes = 1;
  double sound_speed_m_s = 1540;  ///< what the scanner assumes, for time and for range
  double dead_time_s = 0;         ///< added after each stick's echo time 2 d / c
  MotorMode motor = MotorMode::stepped;

  friend bool operator==(const AcquisitionOptions&, const AcquisitionOptions&) = default;
};

template <class Visitor>
void describe(AcquisitionOptions& o, Visitor& v) {
  v.real("depth_mm", o.depth_m, kMillimetre, 1, 400);
  v.real("sector_deg", o.sector_rad, kDegree, 0.1, 170);
  v.real("fan_deg", o.fan_rad, kDegree, 0.1, 170);
  v.integer("sticks_per_frame", o.sticks_per_frame, 1, 1024);
  v.integer("samples_per_stick", o.samples_per_stick, 2, 4096);
  v.integer("frames_per_volume", o.frames_per_volume, 1, 1024);
  v.integer("volumes", o.volumes, 1, 1000);
  v.real("sound_speed_m_s", o.sound_speed_m_s, 1, 1000, 4000);
  v.real("dead_time_us", o.dead_time_s, kMicrosecond, 0, 10000);
  v.choice(
      "motor", o.motor, {{"stepped", MotorMode::stepped}, {"continuous", MotorMode::continuous}});
}

/// Where a stick stands in the stream.
struct StickIndex {
  std::uint32_t volume = 0;
  std::uint32_t frame = 0;
  std::uint32_t line = 0;
};

/// The echo-ranging schedule: a stick takes 2 d / c + dead time, sticks follow each other, frames
/// follow the motor. Every volume sweeps the fan from its negative to its positive end.
class AcquisitionPlan {
 public:
  /// Throws InvalidOption.
  AcquisitionPlan(const ProbeOptions& probe, const AcquisitionOptions& acquisition);

  const ProbeOptions& probe() const { return probe_; }
  const AcquisitionOptions& acquisition() const { return acquisition_; }
  ProbeGeometry geometry() const { return ProbeGeometry(probe_); }

  int sticks_per_volume() const {
    return acquisition_.sticks_per_frame * acquisition_.frames_per_volume;
  }
  /// Position of the stick in the stream, counting from 0.
  std::uint64_t sequence(const StickIndex& index) const;
  StickIndex index(std::uint64_t sequence) const;

  double stick_period_s() const;
  /// When the stick is fired: its sequence number times the period, rounded once to a nanosecond,
  /// so that no error accumulates over a stream of any length. Stays at the end of the device clock
  /// (292 years) for sticks beyond it.
  DeviceTime stick_time(std::uint64_t sequence) const;
  DeviceDuration volume_duration() const;

  /// Stick angle: lines 0 and L-1 lie on the edges of the sector; a lone line looks straight ahead.
  double theta_rad(int line) const;
  /// Motor angle of a frame (stepped), or of its middle (continuous).
  double frame_phi_rad(int frame) const;
  /// Motor angle in the middle of this stick. Stepped: frame_phi_rad(frame). Continuous: the motor
  /// turns one phi_step in each frame, from frame_phi - step / 2 to frame_phi + step / 2, so that
  /// frames join without a jump and line l looks at frame_phi + ((l + 1/2) / L - 1/2) step.
  double motor_angle_rad(const StickIndex& index) const;
  /// Angle between neighbouring sticks, neighbouring frames; 0 where there is only one.
  double theta_step_rad() const;
  double phi_step_rad() const;

  double sample_spacing_m() const { return acquisition_.depth_m / acquisition_.samples_per_stick; }
  /// Range of a sample: its middle, (k + 1/2) d / N.
  double sample_range_m(int sample) const { return (sample + 0.5) * sample_spacing_m(); }

 private:
  ProbeOptions probe_;
  AcquisitionOptions acquisition_;
};

}  // namespace wobblebench::hw
