// A bounded queue of simulated sticks, filled by a thread of its own.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/clock.h"

namespace wobblebench::sim {

/// The samples of some sticks that follow each other.
struct TimedBlock {
  std::vector<float> samples;
  hw::HostTime ready_at;
};

/// Computes the sticks of all volumes of a plan, block after block, on a thread, so that a caller
/// that waits for one can be interrupted during the computation, which may take seconds. One thread
/// calls take() and ready().
class StickFeed {
 public:
  /// Samples of the sticks from a sequence number on; a block lies within one volume.
  using Make = std::function<std::vector<float>(std::uint64_t first_sequence)>;

  /// The plan's volumes from `first_volume` on. `whole_volumes`: blocks are joined to volumes.
  /// `ahead`: volumes that may wait in the queue; 0: no thread, take() computes the block itself.
  /// `notify` is called on the thread when a block is ready.
  StickFeed(Make make,
            const hw::AcquisitionPlan& plan,
            int first_volume,
            bool whole_volumes,
            int ahead,
            std::function<void()> notify);
  ~StickFeed();
  StickFeed(const StickFeed&) = delete;
  StickFeed& operator=(const StickFeed&) = delete;

  /// Whether take() returns without waiting for the thread.
  bool ready() const;
  /// The next block, waiting for it. Throws what its computation threw.
  TimedBlock take();

 private:
  TimedBlock make();
  void fill_queue();

  const Make make_;
  const std::size_t volume_samples_;
  const std::size_t stick_samples_;
  const std::size_t most_samples_;  ///< that may wait before another block is computed
  const std::uint64_t end_;         ///< sequence number behind the last volume
  const bool whole_volumes_;
  const std::function<void()> notify_;
  std::uint64_t next_;  ///< sequence number of the stick that is computed next
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<TimedBlock> queue_;
  std::size_t queued_samples_ = 0;
  std::exception_ptr failure_;
  bool stopping_ = false;
  std::jthread thread_;  ///< last: joined before what it uses is destroyed
};

}  // namespace wobblebench::sim
