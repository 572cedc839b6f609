// The last few volumes of what the sticks of a volume share, each computed once.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

namespace wobblebench::sim {

/// Several threads may ask at the same time; the first computes a volume while others wait.
/// `Volume` has number().
template <class Volume>
class RecentVolumes {
 public:
  /// Number of volumes kept: a thread may still work on one when another begins the next.
  static constexpr int kKept = 3;

  /// Volume `number`, shared between calls; `make()` returns it.
  template <class Make>
  std::shared_ptr<const Volume> of(std::uint32_t number, const Make& make) {
    const std::scoped_lock lock(mutex_);
    for (const auto& kept : kept_) {
      if (kept->number() == number) return kept;
    }
    if (static_cast<int>(kept_.size()) == kKept) kept_.erase(kept_.begin());
    kept_.push_back(make());
    return kept_.back();
  }

 private:
  std::mutex mutex_;
  std::vector<std::shared_ptr<const Volume>> kept_;
};

}  // namespace wobblebench::sim
