// A small recording, for tests of what is measured on one.
#pragma once

#include <string>

#include "tests/hw/support/streams.h"

namespace wobblebench::bench::testing {

/// Few short sticks: quick to encode, whatever is rendered of them.
inline hw::AcquisitionPlan recorded_plan(int frames = 37, int volumes = 1) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 8;
  acquisition.samples_per_stick = 32;
  acquisition.frames_per_volume = frames;
  acquisition.volumes = volumes;
  return {hw::ProbeOptions{}, acquisition};
}

/// The bytes of its recording.
inline std::string recording_of(const hw::AcquisitionPlan& plan) {
  const hw::Bytes bytes = hw::stream_of(plan);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace wobblebench::bench::testing
