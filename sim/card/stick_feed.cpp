#include "sim/card/stick_feed.h"

#include <utility>

namespace wobblebench::sim {

StickFeed::StickFeed(Make make,
                     const hw::AcquisitionPlan& plan,
                     int first_volume,
                     bool whole_volumes,
                     int ahead,
                     std::function<void()> notify)
    : make_(std::move(make)),
      volume_samples_(static_cast<std::size_t>(plan.sticks_per_volume()) *
                      static_cast<std::size_t>(plan.acquisition().samples_per_stick)),
      stick_samples_(static_cast<std::size_t>(plan.acquisition().samples_per_stick)),
      most_samples_(static_cast<std::size_t>(ahead) * volume_samples_),
      end_(plan.first_sequence(
          static_cast<std::uint32_t>(first_volume + plan.acquisition().volumes))),
      whole_volumes_(whole_volumes),
      notify_(std::move(notify)),
      next_(plan.first_sequence(static_cast<std::uint32_t>(first_volume))) {
  if (most_samples_ > 0) thread_ = std::jthread([this] { fill_queue(); });
}

StickFeed::~StickFeed() {
  std::lock_guard lock(mutex_);
  stopping_ = true;
  changed_.notify_all();
}

bool StickFeed::ready() const {
  if (most_samples_ == 0) return true;
  std::lock_guard lock(mutex_);
  return !queue_.empty() || failure_ != nullptr;
}

TimedBlock StickFeed::take() {
  if (most_samples_ == 0) return make();
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !queue_.empty() || failure_ != nullptr; });
  if (queue_.empty()) std::rethrow_exception(failure_);
  TimedBlock block = std::move(queue_.front());
  queue_.pop_front();
  queued_samples_ -= block.samples.size();
  changed_.notify_all();
  return block;
}

TimedBlock StickFeed::make() {
  std::vector<float> samples;
  do {
    std::vector<float> part = make_(next_);
    next_ += part.size() / stick_samples_;
    if (samples.empty()) {
      samples = std::move(part);
      if (whole_volumes_) samples.reserve(volume_samples_);
    } else {
      samples.insert(samples.end(), part.begin(), part.end());
    }
  } while (whole_volumes_ && samples.size() < volume_samples_);
  return {std::move(samples), hw::HostClock::now()};
}

void StickFeed::fill_queue() {
  while (next_ < end_) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopping_ || queued_samples_ < most_samples_; });
      if (stopping_) return;
    }
    TimedBlock block;
    std::exception_ptr failure;
    try {
      block = make();
    } catch (...) {
      failure = std::current_exception();
    }
    {
      std::lock_guard lock(mutex_);
      failure_ = failure;
      if (!failure) {
        queued_samples_ += block.samples.size();
        queue_.push_back(std::move(block));
      }
      changed_.notify_all();
    }
    notify_();
    if (failure) return;
  }
}

}  // namespace wobblebench::sim
