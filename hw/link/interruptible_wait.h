// What a link shares with other threads: its waits, which cancel() and close() end, and its epoch.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>

#include "hw/link/link.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

/// A wait that cancel() and close() of a link end. All functions may be called from any thread.
class InterruptibleWait {
 public:
  void cancel();
  void resume();
  void close();
  /// Status of a read that may not continue: lost after close(), cancelled after cancel().
  std::optional<ReadStatus> interrupted() const;
  /// Ends a sleep early, for an event other than cancel() and close().
  void wake();
  /// Number of calls of wake(). Read it before checking for the event, and pass it to
  /// sleep_until(), so that no wake() is missed in between.
  std::uint64_t wakes() const;
  /// Sleeps until `time`, interrupted(), or wakes() differs from `seen`.
  void sleep_until(HostTime time, std::uint64_t seen);
  void sleep_until(HostTime time) { sleep_until(time, wakes()); }

 private:
  bool is_interrupted() const { return cancelled_ || closed_; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool cancelled_ = false;
  bool closed_ = false;
  std::uint64_t wakes_ = 0;
};

/// The epoch of a link, as Link::epoch() gives it: set by the thread that reads, read by others.
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
