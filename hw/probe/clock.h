// Two clocks without a conversion between them: device time (virtual, exact, given by the
// acquisition schedule) and host time (the steady clock of the machine that runs this program).
#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>

#include "base/duration.h"

namespace wobblebench::hw {

/// Clock of the acquisition: nanoseconds since the first stick of the stream was fired. It has no
/// now(): device time comes from the acquisition plan or from the wire.
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

/// Source of the host time that a link uses: the steady clock, or virtual time in a derived class,
/// for schedules that can be repeated.
///
/// @code
/// struct VirtualTime : hw::HostTimeSource {
///   hw::HostTime now() const override { return time; }
///   hw::HostTime time{};
/// };
/// VirtualTime virtual_time;
/// virtual_time.time += std::chrono::milliseconds(5);
/// if (virtual_time.now() == hw::HostTime{}) return;
/// @endcode
class HostTimeSource {
 public:
  virtual ~HostTimeSource() = default;
  virtual HostTime now() const { return HostClock::now(); }
};

}  // namespace wobblebench::hw
