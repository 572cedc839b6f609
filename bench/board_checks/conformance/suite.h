// The conformance suite: the contract of hw::Board, checked on any link.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"
#include "hw/board/board.h"
#include "hw/link/link.h"

namespace wobblebench::bench {

/// The board's functions as the checks call them; a seeded defect replaces some of them.
struct BoardInterface {
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

/// The functions of `board`, which must outlive them.
BoardInterface interface_of(hw::Board& board);

struct ConformanceFixture {
  std::function<std::unique_ptr<hw::Link>()> open;
  std::function<BoardInterface(hw::Board&)> interface = interface_of;
  /// Each opening sends the same bytes from the start (a recording, a simulation).
  bool repeatable = false;
  /// Faults are injected: losses are expected, and are no failure of the link.
  bool faulty = false;
  /// Pulls the card out, so that an open link loses its device, and puts it back; empty: cannot.
  std::function<void()> unplug;
  std::function<void()> replug;
};

/// Thrown by a check: the rule does not hold.
struct CheckFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Thrown by a check: this link cannot be checked for the rule.
struct CheckSkipped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline void require(bool holds, const std::string& otherwise) {
  if (!holds) throw CheckFailed(otherwise);
}

struct ConformanceCheck {
  std::string name;  ///< dotted: subject.what
  std::string rule;  ///< of the contract, one sentence
  /// Returns the observation, in a few words. Throws CheckFailed, CheckSkipped.
  std::function<std::string(const ConformanceFixture&)> run;
};

/// The fixture for --board ARGS: a new link for each opening. Besides what --board takes elsewhere:
/// "xdma=stand-in", the emulated driver of the card, which lives as long as the fixture, and
/// "xdma=fifo-stand-in". Throws UserError, also if the first opening fails.
ConformanceFixture fixture_of(const BoardArguments& board, const Scene& scene);

/// The fixture with these faults injected into each link (hw/link/fault_link.h).
ConformanceFixture with_faults(const ConformanceFixture& fixture, const std::string& faults);

/// One of each kind of fault, as parse_faults() takes them.
const std::vector<std::string>& each_fault();

struct CheckOutcome {
  enum class Kind { passed, failed, skipped };
  std::string name;
  std::string rule;
  Kind kind = Kind::passed;
  std::string detail;
};
const char* to_string(CheckOutcome::Kind kind);

std::vector<ConformanceCheck> state_checks();
std::vector<ConformanceCheck> slot_checks();
std::vector<ConformanceCheck> account_checks();
std::vector<ConformanceCheck> stream_checks();
std::vector<ConformanceCheck> wait_checks();
std::vector<ConformanceCheck> link_checks();
/// All of them, in the order of the contract.
std::vector<ConformanceCheck> conformance_checks();

CheckOutcome run_check(const ConformanceCheck& check, const ConformanceFixture& fixture);
std::vector<CheckOutcome> run_conformance(const ConformanceFixture& fixture,
                                          const PartDone& done = {});

int count(const std::vector<CheckOutcome>& outcomes, CheckOutcome::Kind kind);

}  // namespace wobblebench::bench
