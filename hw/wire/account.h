// What became of every stick that the source is known to have emitted.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

namespace wobblebench::hw {

enum class LossCause {
  ring_full,     ///< arrived sound, and there was no free slot: the program reads too slowly
  link,          ///< never arrived
  corrupt,       ///< damaged on the way, or contradicts the configuration
  out_of_order,  ///< arrived after sticks that follow it
};

/// "ring_full", "link", "corrupt" or "out_of_order", as reports say it.
const char* to_string(LossCause cause);

/// A run of sticks that are missing from what was delivered.
struct Gap {
  std::uint64_t first_sequence = 0;
  std::uint64_t count = 0;
  LossCause cause = LossCause::link;
};

/// Counts of sticks. Always emitted = delivered + lost.total().
struct BoardAccount {
  struct Lost {
    std::uint64_t ring_full = 0;
    std::uint64_t link = 0;
    std::uint64_t corrupt = 0;
    std::uint64_t out_of_order = 0;
    std::uint64_t total() const { return ring_full + link + corrupt + out_of_order; }
  };
  /// Sticks that sequence numbers prove to have been emitted since the first packet received.
  std::uint64_t emitted = 0;
  std::uint64_t delivered = 0;  ///< put in a slot, in order, for the program to take
  Lost lost;
  /// Copies of sticks that were counted before; they count nowhere else.
  std::uint64_t duplicates = 0;

  bool balanced() const { return emitted == delivered + lost.total(); }
};

/// Keeps a BoardAccount from the sequence numbers as they arrive. Not thread-safe.
class SequenceLedger {
 public:
  /// The next stick, so the stream says, is `sequence`. What is missing before it is counted lost,
  /// and returned: corrupt if there was damage since the last call that moved on, else link.
  std::optional<Gap> advance_to(std::uint64_t sequence, bool after_damage);

  /// True if the stick is the one that comes next. If not, it came late or again, and is counted
  /// so: one that was missed (within the last 1024 gaps) moves from its cause to out_of_order, any
  /// other is a duplicate. Call advance_to(sequence) first.
  bool expects(std::uint64_t sequence);

  /// The stick that comes next was delivered, or lost by `cause`.
  void deliver();
  Gap lose(LossCause cause);

  /// A new stream begins: sequence numbers start anew at the next advance_to().
  void restart();

  /// The stick that comes next; unset before any packet.
  std::optional<std::uint64_t> next() const { return next_; }

  const BoardAccount& account() const { return account_; }

 private:
  std::uint64_t& counter(LossCause cause);
  bool reclassify_missed(std::uint64_t sequence);
  void forget_old_gaps();

  struct Missed {
    std::uint64_t count;
    LossCause cause;
  };
  BoardAccount account_;
  std::optional<std::uint64_t> next_;
  std::map<std::uint64_t, Missed> missed_;  ///< recent gaps by first sequence
};

}  // namespace wobblebench::hw
