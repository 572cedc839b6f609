// What the conformance suite is run on, and how a check says what it found.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "hw/board/board.h"
#include "hw/link/link.h"

namespace wobblebench::bench {

/// The board as the suite sees it: each function is the board's own, unless a deliberately broken
/// one stands in its place.
struct BoardFace {
  std::function<void()> start;
  std::function<void()> stop;
  std::function<void()> cancel;
  std::function<void()> close;
  std::function<hw::Event(hw::HostTime)> next;
  std::function<hw::BoardState()> state;
  std::function<hw::BoardAccount()> account;
  std::function<int()> free_slots;
  std::function<hw::LinkCapabilities()> capabilities;
};

/// `board` must outlive what is returned.
BoardFace face_of(hw::Board& board);

struct ConformanceFixture {
  std::function<std::unique_ptr<hw::Link>()> open;
  std::function<BoardFace(hw::Board&)> face = face_of;
  /// Every opening gives the same bytes from the start (a recording, a simulation).
  bool repeatable = false;
  /// Faults strike on the way: losses are counted, and no fault of the link.
  bool faulty = false;
  /// Pulls the card out, so that an open link loses its device; and puts it back.
  std::function<void()> unplug;
  std::function<void()> replug;
};

/// Thrown by a check: the rule does not hold.
struct CheckFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Thrown by a check: this link cannot show it.
struct CheckSkipped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline void require(bool holds, const std::string& otherwise) {
  if (!holds) throw CheckFailed(otherwise);
}

struct ConformanceCheck {
  std::string name;  ///< dotted: subject.what
  std::string rule;  ///< of the contract, one sentence
  /// Returns what was seen, in a few words. Throws CheckFailed, CheckSkipped.
  std::function<std::string(const ConformanceFixture&)> run;
};

}  // namespace wobblebench::bench
