// When and where each stick of a volume looks.
#pragma once

#include <cstdint>

#include "hw/probe/clock.h"
#include "hw/probe/probe.h"

namespace wobblebench::hw {

/// How the motor moves the image plane. A frame is a plane of the fan in every mode: frame f looks
/// at frame_phi_rad(f), whenever it is acquired.
enum class MotorMode {
  stepped,      ///< the motor rests at one angle while a frame is taken (the paper's assumption)
  continuous,   ///< the motor turns evenly through the frame; each stick has its own angle
  alternating,  ///< continuous; every odd volume sweeps back, from the last frame to the first
  fly_back,     ///< continuous; after each volume the motor returns, which takes `fly_back_s`
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
  /// From the last stick of a volume to the first of the next, where the mode is fly_back. In the
  /// modes stepped and continuous the motor returns in no time.
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
  v.integer("volumes", o.volumes, 1, 1000);
  v.real("sound_speed_m_s", o.sound_speed_m_s, 1, 1000, 4000);
  v.real("dead_time_us", o.dead_time_s, kMicrosecond, 0, 10000);
  v.real("fly_back_ms", o.fly_back_s, kMillisecond, 0, 1000);
  v.choice("motor",
           o.motor,
           {{"stepped", MotorMode::stepped},
            {"continuous", MotorMode::continuous},
            {"alternating", MotorMode::alternating},
            {"fly_back", MotorMode::fly_back}});
}

/// Which place a stick looks at, and in which volume. `frame` names the plane, not its turn: an odd
/// volume of the mode alternating takes frame F - 1 first.
struct StickIndex {
  std::uint32_t volume = 0;
  std::uint32_t frame = 0;
  std::uint32_t line = 0;

  friend bool operator==(const StickIndex&, const StickIndex&) = default;
};

/// The echo-ranging schedule: a stick takes 2 d / c + dead time, sticks follow each other, frames
/// follow the motor. A volume sweeps the fan from its negative to its positive end, or back where
/// sweep_direction() is -1. Lines of a frame are taken from 0 to L - 1 either way.
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
  /// +1: the motor angle grows over this volume; -1: it falls (odd volumes of alternating).
  int sweep_direction(std::uint32_t volume) const;
  /// Position of the stick in the stream, counting from 0: (volume F + turn) L + line, where turn
  /// is the frame, or F - 1 - frame where the volume sweeps back.
  std::uint64_t sequence(const StickIndex& index) const;
  /// The inverse of sequence().
  StickIndex index(std::uint64_t sequence) const;
  /// Sequence number of the volume's first stick.
  std::uint64_t first_sequence(std::uint32_t volume) const;
  /// The stick of a volume that shows a place: of the frame and the line that lie nearest to it.
  StickIndex nearest_stick(const PolarPoint& place, std::uint32_t volume) const;

  double stick_period_s() const;
  /// When the stick is fired: its sequence number times the period, and a fly-back for each volume
  /// before its own, rounded once to a nanosecond, so that no error accumulates over a stream of
  /// any length. Stays at the end of the device clock (292 years) for sticks beyond it.
  DeviceTime stick_time(std::uint64_t sequence) const;
  /// When the last stick of the volume is complete: before the fly-back, if there is one.
  DeviceTime volume_end_time(std::uint32_t volume) const;
  /// From the first stick of a volume to the first of the next: all sticks, and the fly-back if
  /// there is one. What limits the volumes a second.
  DeviceDuration volume_duration() const;

  /// Stick angle: lines 0 and L-1 lie on the edges of the sector; a lone line looks straight ahead.
  double theta_rad(int line) const;
  /// Motor angle of a frame (stepped), or of its middle (all other modes).
  double frame_phi_rad(int frame) const;
  /// Motor angle in the middle of this stick. Stepped: frame_phi_rad(frame). Else the motor turns
  /// one phi_step in each frame, from frame_phi - step / 2 to frame_phi + step / 2, so that frames
  /// join without a jump and line l looks at frame_phi + direction ((l + 1/2) / L - 1/2) step.
  double motor_angle_rad(const StickIndex& index) const;
  /// Angle between neighbouring sticks, neighbouring frames; 0 where there is only one.
  double theta_step_rad() const;
  double phi_step_rad() const;

  double sample_spacing_m() const { return acquisition_.depth_m / acquisition_.samples_per_stick; }
  /// Range of a sample: its middle, (k + 1/2) d / N.
  double sample_range_m(int sample) const { return (sample + 0.5) * sample_spacing_m(); }

 private:
  DeviceTime time_after(std::uint64_t sticks, std::uint64_t fly_backs) const;

  ProbeOptions probe_;
  AcquisitionOptions acquisition_;
};

}  // namespace wobblebench::hw
