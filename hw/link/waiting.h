// What links that wait have in common: a wait that cancel() and close() end from any thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>

#include "hw/link/link.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

/// All functions may be called from any thread.
class Waiting {
 public:
  void cancel();
  void resume();
  void close();
  /// What a read has to give now, whatever there is to read: lost after close(), cancelled after
  /// cancel().
  std::optional<ReadStatus> ended() const;
  /// Ends a sleep from outside: something else came that it waits for.
  void wake();
  /// How often wake() was called. Read before looking for what a sleep would wait for, so that a
  /// wake() in between is not slept through.
  std::uint64_t wakes() const;
  /// Sleeps until `time`, ended() comes to hold, or wakes() is no longer `seen`.
  void sleep_until(HostTime time, std::uint64_t seen);
  void sleep_until(HostTime time) { sleep_until(time, wakes()); }

 private:
  bool has_ended() const { return cancelled_ || closed_; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool cancelled_ = false;
  bool closed_ = false;
  std::uint64_t wakes_ = 0;
};

}  // namespace wobblebench::hw
