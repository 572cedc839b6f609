// Collects the events of a board, for tests.
#pragma once

#include <chrono>
#include <cstddef>
#include <vector>

#include "hw/board/board.h"

namespace wobblebench::hw {

/// A deadline that passes only where a test fails.
inline HostTime patience() {
  return HostClock::now() + std::chrono::seconds(60);
}

struct Collected {
  std::vector<Stick> sticks;
  std::vector<Gap> gaps;
  std::vector<VolumeEnd> ends;
  std::vector<Configuration> configurations;
  /// Sequence numbers in the order of the events: of the sticks, and of all sticks in the gaps.
  std::vector<std::uint64_t> order;
};

/// Adds one event; false for one that carries no data (an end, a timeout).
inline bool note(const Event& event, Collected& seen) {
  if (const auto* slot = std::get_if<StickSlot>(&event)) {
    seen.sticks.push_back(**slot);
    seen.order.push_back((*slot)->sequence);
  } else if (const auto* gap = std::get_if<Gap>(&event)) {
    seen.gaps.push_back(*gap);
    for (std::uint64_t i = 0; i < gap->count; ++i) seen.order.push_back(gap->first_sequence + i);
  } else if (const auto* end = std::get_if<VolumeEnd>(&event)) {
    seen.ends.push_back(*end);
  } else if (const auto* configuration = std::get_if<Configuration>(&event)) {
    seen.configurations.push_back(*configuration);
  } else {
    return false;
  }
  return true;
}

/// Takes events until the first that carries no data, and returns that one.
inline Event collect(Board& board, Collected& seen) {
  for (;;) {
    Event event = board.next(patience());
    if (!note(event, seen)) return event;
  }
}

/// All bytes of a link, in reads of at most `read_bytes`.
inline std::vector<std::byte> all_bytes(Link& link, std::size_t read_bytes) {
  std::vector<std::byte> bytes, buffer(read_bytes);
  for (;;) {
    const ReadResult result = link.read(buffer, patience());
    if (result.status != ReadStatus::ok) return bytes;
    bytes.insert(bytes.end(), buffer.begin(), buffer.begin() + std::ptrdiff_t(result.bytes));
  }
}

}  // namespace wobblebench::hw
