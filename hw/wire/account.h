// Counts of delivered, lost and damaged sticks.
#pragma once

#include <cstdint>

namespace wobblebench::hw {

enum class LossCause {
  ring_full,     ///< arrived intact, no slot was free: the program reads too slowly
  link,          ///< never arrived
  corrupt,       ///< damaged in transfer, or contradicts the configuration
  out_of_order,  ///< arrived after sticks that follow it
};

/// "ring_full", "link", "corrupt" or "out_of_order", as in reports.
constexpr const char* to_string(LossCause cause) {
  switch (cause) {
    case LossCause::ring_full:
      return "ring_full";
    case LossCause::link:
      return "link";
    case LossCause::corrupt:
      return "corrupt";
    case LossCause::out_of_order:
      return "out_of_order";
  }
  return "unknown";
}

/// Consecutive sticks that were not delivered.
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
  std::uint64_t delivered = 0;  ///< put in a slot, in order
  Lost lost;
  /// Copies of sticks that are counted already; not part of any other count.
  std::uint64_t duplicates = 0;

  bool balanced() const { return emitted == delivered + lost.total(); }
};

/// Damage that a decoder skipped.
struct WireDamage {
  std::uint64_t regions = 0;        ///< runs of bytes that belong to no accepted packet
  std::uint64_t bytes_skipped = 0;  ///< in all regions
};

}  // namespace wobblebench::hw
