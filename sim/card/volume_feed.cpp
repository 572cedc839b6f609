#include "sim/card/volume_feed.h"

#include <utility>

namespace wobblebench::sim {

VolumeFeed::VolumeFeed(Make make, std::uint32_t volumes, int ahead, std::function<void()> changed)
    : make_(std::move(make)),
      volumes_(volumes),
      ahead_(static_cast<std::size_t>(ahead)),
      changed_(std::move(changed)) {
  if (ahead_ > 0) thread_ = std::thread([this] { make_ahead(); });
}

VolumeFeed::~VolumeFeed() {
  {
    std::lock_guard lock(mutex_);
    over_ = true;
    moved_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

bool VolumeFeed::ready() const {
  if (ahead_ == 0) return true;
  std::lock_guard lock(mutex_);
  return !made_.empty() || failure_ != nullptr;
}

MadeVolume VolumeFeed::take() {
  if (ahead_ == 0) return make();
  std::unique_lock lock(mutex_);
  moved_.wait(lock, [this] { return !made_.empty() || failure_ != nullptr; });
  if (made_.empty()) std::rethrow_exception(failure_);
  MadeVolume volume = std::move(made_.front());
  made_.pop_front();
  moved_.notify_all();
  return volume;
}

MadeVolume VolumeFeed::make() {
  VolumeSamples samples = make_(next_++);
  return {std::move(samples), hw::HostClock::now()};
}

void VolumeFeed::make_ahead() {
  while (next_ < volumes_) {
    {
      std::unique_lock lock(mutex_);
      moved_.wait(lock, [this] { return over_ || made_.size() < ahead_; });
      if (over_) return;
    }
    MadeVolume volume;
    std::exception_ptr failure;
    try {
      volume = make();
    } catch (...) {
      failure = std::current_exception();
    }
    {
      std::lock_guard lock(mutex_);
      failure_ = failure;
      if (!failure) made_.push_back(std::move(volume));
      moved_.notify_all();
    }
    changed_();
    if (failure) return;
  }
}

}  // namespace wobblebench::sim
