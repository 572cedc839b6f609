// One stick (scan line): the detected samples along one beam axis, as the board delivers them.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

/// Scale of a stick's samples.
enum class SampleScale : std::uint8_t {
  log_compressed = 0,  ///< [0, 1] over the dynamic range
  linear_envelope = 1,
};

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

}  // namespace wobblebench::hw
