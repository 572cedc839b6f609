// Volumes of samples, made ahead of whoever sends them.
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

struct MadeVolume {
  VolumeSamples samples;
  hw::HostTime at;  ///< when it was ready
};

/// Makes volumes 0, 1, … on a thread of its own, so that whoever waits for one can be interrupted
/// while a volume, which may take seconds, is made. take() and ready() are for one thread, wake()
/// for any.
class VolumeFeed {
 public:
  using Make = std::function<VolumeSamples(std::uint32_t)>;

  /// `ahead` volumes wait at most; 0: no thread, take() makes the volume itself. `changed` is
  /// called on the feed's thread when a volume became ready.
  VolumeFeed(Make make, std::uint32_t volumes, int ahead, std::function<void()> changed);
  ~VolumeFeed();
  VolumeFeed(const VolumeFeed&) = delete;
  VolumeFeed& operator=(const VolumeFeed&) = delete;

  /// take() would not wait.
  bool ready() const;
  /// The next volume, waiting for it. Throws what making it threw.
  MadeVolume take();

 private:
  MadeVolume make();
  void make_ahead();

  const Make make_;
  const std::uint32_t volumes_;
  const std::size_t ahead_;
  const std::function<void()> changed_;
  std::uint32_t next_ = 0;  ///< of the volume that is made next
  mutable std::mutex mutex_;
  std::condition_variable moved_;
  std::deque<MadeVolume> made_;
  std::exception_ptr failure_;
  bool over_ = false;
  std::thread thread_;
};

}  // namespace wobblebench::sim
