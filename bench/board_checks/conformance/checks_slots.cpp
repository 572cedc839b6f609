// Rule 2: ownership of slots.
#include <vector>

#include "bench/board_checks/conformance/board_session.h"
#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

namespace {

/// Slots held while other sticks are received.
struct Held {
  std::vector<hw::StickSlot> slots;
  std::vector<std::uint64_t> fingerprints;

  void hold(hw::StickSlot slot) {
    fingerprints.push_back(fingerprint(*slot));
    slots.push_back(std::move(slot));
  }
  void require_unchanged(const std::string& when) const {
    for (std::size_t i = 0; i < slots.size(); ++i) {
      require(fingerprint(*slots[i]) == fingerprints[i], "a held slot changed " + when);
    }
  }
};

std::string held_unchanged(const ConformanceFixture& fixture) {
  BoardSession session(fixture, 8);
  session.board.start();
  Held held;
  for (int i = 0; i < 4; ++i) held.hold(session.receive_slot());
  session.receive_all(100);
  held.require_unchanged("while 100 sticks passed");
  return "4 of 8 slots held while 100 sticks passed";
}

std::string readable_after_close(const ConformanceFixture& fixture) {
  Held held;
  {
    BoardSession session(fixture, 8);
    session.board.start();
    for (int i = 0; i < 4; ++i) held.hold(session.receive_slot());
    session.board.stop();
    held.require_unchanged("at stop()");
    session.board.close();
    held.require_unchanged("at close()");
  }
  held.require_unchanged("when the board was destroyed");
  return "4 slots read after the board was gone";
}

std::string credit_on_release(const ConformanceFixture& fixture) {
  constexpr int kSlots = 16;
  BoardSession session(fixture, kSlots);
  require(session.board.free_slots() == kSlots, "a new board's slots are not all free");
  session.board.start();
  Held held;
  for (int i = 0; i < 5; ++i) held.hold(session.receive_slot());
  require(session.board.free_slots() <= kSlots - 5, "a held slot counts as free");
  session.board.stop();
  for (;;) {
    hw::Event event = session.board.next(hw::HostTime::min());
    Received received;
    if (!record_event(event, received)) break;
  }
  require(session.board.free_slots() == kSlots - 5, "with 5 held, not all others are free");
  held.slots.clear();
  require(session.board.free_slots() == kSlots, "a released slot is not free");
  return "5 of 16 held, then released";
}

}  // namespace

std::vector<ConformanceCheck> slot_checks() {
  return {
      {"slots.held", "The board never writes a slot that is held", held_unchanged},
      {"slots.outlive",
       "Held slots stay readable after stop, close and the board",
       readable_after_close},
      {"slots.credit", "A slot is free again when it is released, not before", credit_on_release},
  };
}

}  // namespace wobblebench::bench
