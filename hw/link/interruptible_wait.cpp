#include "hw/link/interruptible_wait.h"

namespace wobblebench::hw {

void InterruptibleWait::cancel() {
  std::lock_guard lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

void InterruptibleWait::resume() {
  std::lock_guard lock(mutex_);
  cancelled_ = false;
}

void InterruptibleWait::close() {
  std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<ReadStatus> InterruptibleWait::interrupted() const {
  std::lock_guard lock(mutex_);
  if (closed_) return ReadStatus::lost;
  if (cancelled_) return ReadStatus::cancelled;
  return {};
}

void InterruptibleWait::wake() {
  std::lock_guard lock(mutex_);
  ++wakes_;
  changed_.notify_all();
}

std::uint64_t InterruptibleWait::wakes() const {
  std::lock_guard lock(mutex_);
  return wakes_;
}

void InterruptibleWait::sleep_until(HostTime time, std::uint64_t seen) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, time, [&] { return is_interrupted() || wakes_ != seen; });
}

}  // namespace wobblebench::hw
