// A thread that works on the newest of what it is given.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace wobblebench::bench {

/// Calls `work` on a thread of its own, one item at a time; an item that still waits is replaced
/// by a newer one. `work` must not throw.
template <class Item>
class NewestWorker {
 public:
  explicit NewestWorker(std::function<void(const Item&)> work)
      : work_(std::move(work)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  void give(Item item) {
    const std::lock_guard lock(mutex_);
    waiting_ = std::move(item);
    changed_.notify_all();
  }

 private:
  void run(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return waiting_.has_value(); })) {
      const Item item = *std::exchange(waiting_, std::nullopt);
      lock.unlock();
      work_(item);
      lock.lock();
      if (stop.stop_requested()) return;
    }
  }

  const std::function<void(const Item&)> work_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Item> waiting_;
  std::jthread thread_;  ///< last: joined before what it uses is destroyed
};

}  // namespace wobblebench::bench
