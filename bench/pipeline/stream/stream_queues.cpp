#include "bench/pipeline/stream/stream_queues.h"

#include <algorithm>
#include <utility>

#include "base/duration.h"

namespace wobblebench::bench {

VolumeQueue::VolumeQueue(const QueueOptions& options) : options_(options) {
  check_options(options_);
}

bool VolumeQueue::has_room(std::uint32_t volume) const {
  if (options_.policy == StreamPolicy::newest) return true;
  const bool is_under_way = !waiting_.empty() && waiting_.back().volume == volume;
  return is_under_way || static_cast<int>(waiting_.size()) < options_.volumes;
}

bool VolumeQueue::push(StreamFrame frame) {
  std::unique_lock lock(mutex_);
  if (!has_room(frame.volume) && !stopped_) {
    const auto start = hw::HostClock::now();
    changed_.wait(lock, [&] { return stopped_ || has_room(frame.volume); });
    statistics_.blocked_ms += to_milliseconds(hw::HostClock::now() - start);
  }
  if (stopped_) {
    statistics_.left_sticks += static_cast<std::uint64_t>(frame.sticks);
    return false;
  }
  count_occupancy();
  if (waiting_.empty() || waiting_.back().volume != frame.volume || waiting_.back().whole) {
    waiting_.push_back({.volume = frame.volume, .frames = {}});
    statistics_.most_volumes =
        std::max(statistics_.most_volumes, static_cast<int>(waiting_.size()));
  }
  Waiting& under_way = waiting_.back();
  under_way.sticks += static_cast<std::uint64_t>(frame.sticks);
  under_way.whole = frame.ends_volume;
  under_way.frames.push_back(std::move(frame));
  if (under_way.whole && options_.policy == StreamPolicy::newest) drop_superseded();
  changed_.notify_all();
  return true;
}

/// Drops what waits before the whole volume at the back, but the one that was begun.
void VolumeQueue::drop_superseded() {
  while (waiting_.size() > 1) {
    auto oldest = waiting_.begin();
    if (oldest->begun) ++oldest;
    if (oldest + 1 == waiting_.end()) return;
    ++statistics_.superseded.volumes;
    statistics_.superseded.sticks += oldest->sticks;
    waiting_.erase(oldest);
  }
}

void VolumeQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void VolumeQueue::stop() {
  const std::lock_guard lock(mutex_);
  if (stopped_) return;
  stopped_ = true;
  for (const Waiting& volume : waiting_) statistics_.left_sticks += volume.sticks;
  waiting_.clear();
  changed_.notify_all();
}

bool VolumeQueue::is_ready() const {
  return !waiting_.empty() && !waiting_.front().frames.empty();
}

bool VolumeQueue::wait_for(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, time, [&] { return stopped_ || is_ready() || closed_; });
}

std::optional<StreamFrame> VolumeQueue::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return stopped_ || is_ready() || closed_; });
  if (stopped_ || !is_ready()) return {};
  count_occupancy();
  Waiting& volume = waiting_.front();
  StreamFrame frame = std::move(volume.frames.front());
  volume.frames.pop_front();
  volume.begun = true;
  if (volume.whole && volume.frames.empty()) waiting_.pop_front();
  changed_.notify_all();
  return frame;
}

bool VolumeQueue::empty() const {
  const std::lock_guard lock(mutex_);
  return !is_ready();
}

int VolumeQueue::volumes() const {
  const std::lock_guard lock(mutex_);
  return static_cast<int>(waiting_.size());
}

void VolumeQueue::count_occupancy() {
  const auto now = hw::HostClock::now();
  if (!first_) first_ = counted_ = now;
  volume_ms_ += static_cast<double>(waiting_.size()) * to_milliseconds(now - *counted_);
  counted_ = now;
}

QueueStatistics VolumeQueue::statistics() const {
  const std::lock_guard lock(mutex_);
  QueueStatistics statistics = statistics_;
  const double all_ms = first_ ? to_milliseconds(*counted_ - *first_) : 0;
  statistics.mean_volumes = all_ms > 0 ? volume_ms_ / all_ms : 0;
  return statistics;
}

std::optional<ShownPicture> PictureQueue::push(ShownPicture picture) {
  std::unique_lock lock(mutex_);
  if (policy_ == StreamPolicy::every) {
    changed_.wait(lock, [&] { return closed_ || !waiting_; });
  }
  if (closed_) return picture;
  std::optional<ShownPicture> replaced = std::exchange(waiting_, std::move(picture));
  changed_.notify_all();
  return replaced;
}

void PictureQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<ShownPicture> PictureQueue::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return closed_ || waiting_; });
  auto picture = std::exchange(waiting_, std::nullopt);
  changed_.notify_all();
  return picture;
}

}  // namespace wobblebench::bench
