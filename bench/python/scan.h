// Volumes as Python holds them, and where they come from.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "hw/probe/polar_volume.h"
#include "hw/wire/configuration.h"

namespace wobblebench::python {

/// The samples of a volume in one piece, log-compressed, and what is known of its sticks.
struct VolumeData {
  VolumeData(const hw::AcquisitionPlan& of, std::uint32_t number);

  /// Copies one frame.
  void set_frame(int frame, const hw::PolarFrame& from);
  hw::PolarFrame frame(int frame) const;
  hw::PolarVolume polar() const;

  hw::AcquisitionPlan plan;
  std::uint32_t index;                  ///< in the stream, from 0
  hw::SubjectHash subject;              ///< what they are of, where that is known
  bool knows_times = true;              ///< of its sticks
  std::vector<float> samples;           ///< [frame][line][sample]
  std::vector<std::uint8_t> arrived;    ///< [frame][line]
  std::vector<double> motor_angle_rad;  ///< [frame][line]
};

using VolumePointer = std::shared_ptr<VolumeData>;

void add_scan(pybind11::module_& module);

}  // namespace wobblebench::python
