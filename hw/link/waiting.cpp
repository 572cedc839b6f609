#include "hw/link/waiting.h"

namespace wobblebench::hw {

void Waiting::cancel() {
  std::lock_guard lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

void Waiting::resume() {
  std::lock_guard lock(mutex_);
  cancelled_ = false;
}

void Waiting::close() {
  std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<ReadStatus> Waiting::ended() const {
  std::lock_guard lock(mutex_);
  if (closed_) return ReadStatus::lost;
  if (cancelled_) return ReadStatus::cancelled;
  return {};
}

void Waiting::wake() {
  std::lock_guard lock(mutex_);
  ++wakes_;
  changed_.notify_all();
}

std::uint64_t Waiting::wakes() const {
  std::lock_guard lock(mutex_);
  return wakes_;
}

void Waiting::sleep_until(HostTime time, std::uint64_t seen) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, time, [&] { return has_ended() || wakes_ != seen; });
}

}  // namespace wobblebench::hw
