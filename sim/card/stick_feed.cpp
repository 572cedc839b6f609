#include "sim/card/stick_feed.h"

#include <utility>

namespace wobblebench::sim {

VolumeFeed::VolumeFeed(Make make, std::uint32_t volumes, int ahead, std::function<void()> notify)
    : make_(std::move(make)),
      volumes_(volumes),
      ahead_(static_cast<std::size_t>(ahead)),
      notify_(std::move(notify)) {
  if (ahead_ > 0) thread_ = std::jthread([this] { fill_queue(); });
}

VolumeFeed::~VolumeFeed() {
  std::lock_guard lock(mutex_);
  stopping_ = true;
  changed_.notify_all();
}

bool VolumeFeed::ready() const {
  if (ahead_ == 0) return true;
  std::lock_guard lock(mutex_);
  return !queue_.empty() || failure_ != nullptr;
}

TimedVolume VolumeFeed::take() {
  if (ahead_ == 0) return make();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !queue_.empty() || failure_ != nullptr; });
  if (queue_.empty()) std::rethrow_exception(failure_);
  TimedVolume volume = std::move(queue_.front());
  queue_.pop_front();
  changed_.notify_all();
  return volume;
}

TimedVolume VolumeFeed::make() {
  VolumeSamples samples = make_(next_++);
  return {std::move(samples), hw::HostClock::now()};
}

void VolumeFeed::fill_queue() {
  while (next_ < volumes_) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || queue_.size() < ahead_; });
      if (stopping_) return;
    }
    TimedVolume volume;
    std::exception_ptr failure;
    try {
      volume = make();
    } catch (...) {
      failure = std::current_exception();
    }
    {
      std::lock_guard lock(mutex_);
      failure_ = failure;
      if (!failure) queue_.push_back(std::move(volume));
      changed_.notify_all();
    }
    notify_();
    if (failure) return;
  }
}

}  // namespace wobblebench::sim
