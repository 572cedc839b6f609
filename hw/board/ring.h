// The fixed pool of stick slots between the board's reader thread and the program.
#pragma once

#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::hw {

/// A slot is free or taken. Only its holder accesses a taken slot, and only release() frees it. All
/// functions may be called from any thread.
class StickRing {
 public:
  /// Throws InvalidOption unless `slots` is within the range of BoardOptions::ring_slots.
  explicit StickRing(int slots);

  /// Takes a free slot; null if there is none. Its content is that of an earlier stick.
  [[nodiscard]] Stick* acquire();
  /// Waits for a free slot; null only if a stop is requested.
  [[nodiscard]] Stick* wait(const std::stop_token& stop);
  /// Frees a slot of this ring, once.
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
