// The epoch of a link, set by the thread that reads and read by others.
#pragma once

#include <atomic>
#include <limits>
#include <optional>

#include "hw/probe/clock.h"

namespace wobblebench::hw {

/// As Link::epoch() gives it.
class SharedEpoch {
 public:
  void set(HostTime epoch) { since_.store(epoch.time_since_epoch().count()); }
  std::optional<HostTime> get() const {
    const auto since = since_.load();
    if (since == kNone) return {};
    return HostTime(HostClock::duration(since));
  }

 private:
  static constexpr HostClock::rep kNone = std::numeric_limits<HostClock::rep>::min();
  std::atomic<HostClock::rep> since_ = kNone;
};

}  // namespace wobblebench::hw
