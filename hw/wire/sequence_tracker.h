// Classifies sticks by their sequence numbers: next, late, repeated or missing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "hw/wire/account.h"

namespace wobblebench::hw {

/// Updates a BoardAccount from the sequence numbers in the order of arrival. Not thread-safe.
class SequenceTracker {
 public:
  /// The stream says that stick `sequence` comes next. What is missing before it is counted as lost
  /// and returned; cause: corrupt if there was damage since the last call that advanced, else link.
  /// Throws UnreadableStream for more sticks than can be counted.
  std::optional<Gap> advance_to(std::uint64_t sequence, bool after_damage);

  /// True if the stick is the next one. If not, it is late or repeated and counted as such: one
  /// that is missing (in the last 1024 gaps) moves from its cause to out_of_order, any other is a
  /// duplicate. Call advance_to(sequence) first.
  [[nodiscard]] bool expects(std::uint64_t sequence);

  /// Counts the next stick as delivered, or as lost by `cause`.
  void deliver();
  Gap lose(LossCause cause);

  /// A new stream: sequence numbers start anew at the next advance_to(). Keeps the counts.
  void restart();

  /// The next stick; unset before any packet.
  std::optional<std::uint64_t> next() const { return next_; }

  const BoardAccount& account() const { return account_; }

 private:
  std::uint64_t& counter(LossCause cause);
  bool reclassify_missing(std::uint64_t sequence);
  void forget_old_gaps();

  struct Missing {
    std::uint64_t count;
    LossCause cause;
  };
  BoardAccount account_;
  std::optional<std::uint64_t> next_;
  std::map<std::uint64_t, Missing> missing_;  ///< recent gaps, by first sequence number
};

}  // namespace wobblebench::hw
