// Counts of messages that were not taken.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace wobblebench::bench {

/// Used by any threads.
class LeftOut {
 public:
  /// `why`: of a bounded number of reasons.
  void count(const std::string& why) {
    const std::lock_guard lock(mutex_);
    ++counts_[counts_.size() < kMostReasons || counts_.contains(why) ? why : "others"];
  }
  /// "TRANSFORM messages (37), has a wrong CRC (1)"; empty: none was left out.
  std::string text() const {
    const std::lock_guard lock(mutex_);
    std::string text;
    for (const auto& [why, count] : counts_) {
      text.append(text.empty() ? "" : ", ").append(why);
      text.append(" (").append(std::to_string(count)).append(")");
    }
    return text;
  }

 private:
  static constexpr std::size_t kMostReasons = 16;

  mutable std::mutex mutex_;
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace wobblebench::bench
