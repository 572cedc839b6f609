#include "hw/board/ring.h"

#include <cstddef>

#include "base/options.h"
#include "hw/board/board.h"

namespace wobblebench::hw {
namespace {

std::size_t checked(int slots) {
  check_options(BoardOptions{.ring_slots = slots});
  return static_cast<std::size_t>(slots);
}

}  // namespace

StickRing::StickRing(int slots) : sticks_(checked(slots)) {
  free_.reserve(sticks_.size());
  for (Stick& stick : sticks_) free_.push_back(&stick);
}

Stick* StickRing::pop_free() {
  Stick* slot = free_.back();
  free_.pop_back();
  return slot;
}

Stick* StickRing::acquire() {
  std::lock_guard lock(mutex_);
  return free_.empty() ? nullptr : pop_free();
}

Stick* StickRing::wait(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  ++waiting_;
  const bool freed = freed_.wait(lock, stop, [this] { return !free_.empty(); });
  --waiting_;
  return freed ? pop_free() : nullptr;
}

void StickRing::release(Stick* slot) {
  std::lock_guard lock(mutex_);
  free_.push_back(slot);
  if (waiting_ > 0) freed_.notify_one();
}

int StickRing::free_slots() const {
  std::lock_guard lock(mutex_);
  return static_cast<int>(free_.size());
}

}  // namespace wobblebench::hw
