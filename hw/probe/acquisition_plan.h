// The acquisition schedule: time and angles of each stick.
#pragma once

#include <cstdint>

#include "hw/probe/clock.h"
#include "hw/probe/probe.h"

namespace wobblebench::hw {

/// How the motor moves the image plane. In every mode frame f is the plane of the fan at
/// frame_phi_rad(f), in whichever order frames are acquired.
enum class MotorMode {
  stepped,      ///< motor at rest during a frame (the paper's assumption)
  continuous,   ///< constant motor speed; each stick has its own motor angle
  alternating,  ///< continuous; odd volumes sweep back, from the last frame to the first
  fly_back,     ///< continuous; after each volume the motor returns in `fly_back_s`
};

/// Half a day of the default scan.
inline constexpr int kMostVolumes = 100000;

/// Extent and sampling of a volume. Defaults: the paper's reference settings.
struct AcquisitionOptions {
  double depth_m = 0.16;  ///< longest range from the face
  double sector_rad = 77 * kDegree;
  double fan_rad = 61 * kDegree;
  int sticks_per_frame = 64;
  int samples_per_stick = 512;
  int frames_per_volume = 37;
  int volumes = 1;
  double sound_speed_m_s = 1540;  ///< as assumed by the scanner, for time and for range
  double dead_time_s = 0;         ///< added after each stick's echo time 2 d / c
  /// Number of equal zones of the depth, each with a transmission of its own, which is focused at
  /// the zone's middle: a stick takes that number of echo times. 1: one, at the probe's focus.
  int focal_zones = 1;
  /// Mode fly_back: from the end of a volume's last stick to the first of the next. In the modes
  /// stepped and continuous the motor returns in no time.
  double fly_back_s = 50e-3;
  MotorMode motor = MotorMode::stepped;

  friend bool operator==(const AcquisitionOptions&, const AcquisitionOptions&) = default;
};

template <OptionsOf<AcquisitionOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.real("depth_mm", o.depth_m, kMillimetre, 1, 400);
  v.real("sector_deg", o.sector_rad, kDegree, 0.1, 170);
  v.real("fan_deg", o.fan_rad, kDegree, 0.1, 170);
  v.integer("sticks_per_frame", o.sticks_per_frame, 1, 1024);
  v.integer("samples_per_stick", o.samples_per_stick, 2, 4096);
  v.integer("frames_per_volume", o.frames_per_volume, 1, 1024);
  v.integer("volumes", o.volumes, 1, kMostVolumes);
  v.real("sound_speed_m_s", o.sound_speed_m_s, 1, 1000, 4000);
  v.real("dead_time_us", o.dead_time_s, kMicrosecond, 0, 10000);
  v.integer("focal_zones", o.focal_zones, 1, 8);
  v.real("fly_back_ms", o.fly_back_s, kMillisecond, 0, 1000);
  v.choice("motor",
           o.motor,
           {{"stepped", MotorMode::stepped},
            {"continuous", MotorMode::continuous},
            {"alternating", MotorMode::alternating},
            {"fly_back", MotorMode::fly_back}});
}

/// The same schedule with the transmissions of all zones but one as dead time: what a receiver has
/// to know, and all that the wire format says.
AcquisitionOptions with_one_zone(AcquisitionOptions acquisition);

/// Volume, frame and line of a stick, from 0. `frame` is the plane in the fan, not the order of
/// acquisition: an odd volume of the mode alternating starts with frame F - 1.
struct StickIndex {
  std::uint32_t volume = 0;
  std::uint32_t frame = 0;
  std::uint32_t line = 0;

  friend bool operator==(const StickIndex&, const StickIndex&) = default;
};

/// The echo-ranging schedule: a stick takes 2 d / c for each of its zones + dead time, sticks
/// follow each other, frames follow the motor. A volume sweeps the fan from its negative to its
/// positive end, or back where sweep_direction() is -1. In both directions the lines of a frame are
/// acquired from 0 to L - 1.
///
/// @code
/// hw::AcquisitionOptions acquisition;
/// acquisition.frames_per_volume = 60;
/// const hw::AcquisitionPlan plan(hw::ProbeOptions{}, acquisition);
/// const hw::StickIndex index = plan.index(1000);
/// const double phi_rad = plan.motor_angle_rad(index);
/// const hw::DeviceTime fired = plan.stick_time(plan.sequence(index));
/// if (phi_rad > 0 && fired > hw::DeviceTime{}) return;
/// @endcode
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
  /// +1: the motor angle increases over this volume; -1: it decreases (odd volumes of alternating).
  int sweep_direction(std::uint32_t volume) const;
  /// Index of the stick in the stream, from 0: (volume F + f) L + line, where f is the frame, or
  /// F - 1 - frame where the volume sweeps back. Throws std::out_of_range for a frame or line that
  /// the plan does not have.
  std::uint64_t sequence(const StickIndex& index) const;
  /// Inverse of sequence(). Throws std::out_of_range unless has_stick().
  StickIndex index(std::uint64_t sequence) const;
  /// False beyond the last stick of volume 2^32 - 1, the last that can be numbered.
  bool has_stick(std::uint64_t sequence) const;
  /// Sequence number of the volume's first stick.
  std::uint64_t first_sequence(std::uint32_t volume) const;
  /// The stick of the frame and the line nearest in angle to `point`.
  StickIndex nearest_stick(const PolarPoint& point, std::uint32_t volume) const;

  double stick_period_s() const;
  /// Transmit time of the stick: its sequence number times the period, and a fly-back for each
  /// earlier volume, rounded once to a nanosecond, so that no error accumulates. For any number:
  /// saturates at the end of the device clock (292 years).
  DeviceTime stick_time(std::uint64_t sequence) const;
  /// End of the volume's last stick, before any fly-back.
  DeviceTime volume_end_time(std::uint32_t volume) const;
  /// From the first stick of a volume to the first of the next, any fly-back included: the inverse
  /// of the volume rate.
  DeviceDuration volume_duration() const;

  /// Stick angle: lines 0 and L-1 lie on the edges of the sector; a single line has angle 0.
  double theta_rad(int line) const;
  /// Motor angle of a frame (stepped), or of its centre (all other modes).
  double frame_phi_rad(int frame) const;
  /// Motor angle at the centre of the stick's time. Stepped: frame_phi_rad(frame). Else the motor
  /// turns by phi_step in each frame, from frame_phi - step / 2 to frame_phi + step / 2, so that
  /// frames join and line l is at frame_phi + direction ((l + 1/2) / L - 1/2) step.
  double motor_angle_rad(const StickIndex& index) const;
  /// Angle between neighbouring sticks or frames; 0 where there is only one.
  double theta_step_rad() const;
  double phi_step_rad() const;

  double sample_spacing_m() const { return acquisition_.depth_m / acquisition_.samples_per_stick; }
  /// Range of the centre of sample k: (k + 1/2) d / N.
  double sample_range_m(int sample) const { return (sample + 0.5) * sample_spacing_m(); }

 private:
  /// Time at which these numbers of sticks and of fly-backs have passed.
  DeviceTime time_after(std::uint64_t sticks, std::uint64_t fly_backs) const;

  ProbeOptions probe_;
  AcquisitionOptions acquisition_;
};

}  // namespace wobblebench::hw
