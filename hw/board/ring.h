// The fixed store of sticks between the thread that reads a link and the program.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <vector>

#include "hw/probe/stick.h"

namespace wobblebench::hw {

inline constexpr int kMaxRingSlots = 1 << 20;

/// A fixed number of slots. A slot is free or taken; nobody but its holder touches a taken slot,
/// and only release() makes it free. All functions may be called from any thread.
class StickRing {
 public:
  /// Throws InvalidOption unless slots is within 1 and kMaxRingSlots.
  explicit StickRing(int slots);

  /// A free slot, now taken by the caller, or null if there is none. What it holds is old.
  Stick* acquire();
  /// Waits for a free slot; null only if a stop is requested.
  Stick* wait(const std::stop_token& stop);
  /// Gives a slot back. `slot` came from this ring and is given back once.
  void release(Stick* slot);

  int free_slots() const;
  int slots() const { return static_cast<int>(sticks_.size()); }

 private:
  Stick* pop_free();

  mutable std::mutex mutex_;
  std::condition_variable_any freed_;
  int waiting_ = 0;  ///< threads inside wait()
  std::vector<Stick> sticks_;
  std::vector<Stick*> free_;
};

}  // namespace wobblebench::hw
