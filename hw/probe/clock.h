// Two clocks that do not convert into each other: device time (virtual, exact, what the probe's
// schedule says) and host time (the wall clock of the machine that runs this program).
#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>

namespace wobblebench::hw {

/// The clock of the acquisition: nanoseconds since the first stick of the stream was fired.
/// It has no `now()`; device time comes from the acquisition plan or from the wire.
struct DeviceClock {
  using rep = std::int64_t;
  using period = std::nano;
  using duration = std::chrono::nanoseconds;
  using time_point = std::chrono::time_point<DeviceClock>;
  static constexpr bool is_steady = true;
};

using DeviceTime = DeviceClock::time_point;
using DeviceDuration = DeviceClock::duration;

using HostClock = std::chrono::steady_clock;
using HostTime = HostClock::time_point;

/// What time a link takes it to be: the host's, or that of a schedule that can be repeated.
class HostTimeSource {
 public:
  virtual ~HostTimeSource() = default;
  virtual HostTime now() const { return HostClock::now(); }
};

inline double to_milliseconds(DeviceDuration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

}  // namespace wobblebench::hw
