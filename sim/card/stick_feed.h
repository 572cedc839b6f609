// A bounded queue of simulated volumes, filled by a thread of its own.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "hw/probe/clock.h"
#include "sim/probe_simulator.h"

namespace wobblebench::sim {

struct TimedVolume {
  VolumeSamples samples;
  hw::HostTime ready_at;
};

/// Computes volumes 0, 1, … on a thread, so that a caller that waits for one can be interrupted
/// during the computation, which may take seconds. One thread calls take() and ready().
class VolumeFeed {
 public:
  using Make = std::function<VolumeSamples(std::uint32_t)>;

  /// `ahead`: capacity of the queue; 0: no thread, take() computes the volume itself. `notify` is
  /// called on the thread when a volume is ready.
  VolumeFeed(Make make, std::uint32_t volumes, int ahead, std::function<void()> notify);
  ~VolumeFeed();
  VolumeFeed(const VolumeFeed&) = delete;
  VolumeFeed& operator=(const VolumeFeed&) = delete;

  /// Whether take() returns without waiting for the thread.
  bool ready() const;
  /// The next volume, waiting for it. Throws what its computation threw.
  TimedVolume take();

 private:
  TimedVolume make();
  void fill_queue();

  const Make make_;
  const std::uint32_t volumes_;
  const std::size_t ahead_;
  const std::function<void()> notify_;
  std::uint32_t next_ = 0;  ///< number of the volume that is computed next
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<TimedVolume> queue_;
  std::exception_ptr failure_;
  bool stopping_ = false;
  std::jthread thread_;  ///< last: joined before what it uses is destroyed
};

}  // namespace wobblebench::sim
