// Rule 2: ownership of slots. Rule 3: every stick is delivered, or counted as lost by its cause.
// Rule 4: which errors are not fatal.
#include <thread>
#include <vector>

#include "bench/board_checks/conformance/board_session.h"
#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kAccountSticks = 400;

std::string numbers(const hw::BoardAccount& account) {
  return "emitted " + std::to_string(account.emitted) + ", delivered " +
         std::to_string(account.delivered) + ", lost " + std::to_string(account.lost.total());
}

void require_balanced(const hw::BoardAccount& account) {
  require(account.balanced(), numbers(account));
}

std::string balanced(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  Received received;
  while (received.sticks.size() < kAccountSticks && !received.over) {
    session.receive(received, received.sticks.size() + 1);
    require_balanced(session.board.account());
  }
  session.board.stop();
  require_balanced(session.board.account());
  return numbers(session.board.account());
}

/// Sticks and gaps, in order, cover every sequence number from the first to the last once.
void require_contiguous(const Received& received) {
  for (std::size_t i = 1; i < received.order.size(); ++i) {
    const auto& before = received.order[i - 1];
    require(received.order[i].first == before.first + before.count,
            "after " + std::to_string(before.first + before.count - 1) + " comes " +
                std::to_string(received.order[i].first) + " with no gap reported");
  }
}

std::string contiguous(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  Received received;
  session.receive(received, kAccountSticks);
  require_contiguous(received);
  std::uint64_t missing = 0;
  for (const hw::Gap& gap : received.gaps) missing += gap.count;
  session.board.stop();
  require(session.board.account().lost.total() >= missing, "a gap was reported and not counted");
  return std::to_string(received.sticks.size()) + " sticks, " +
         std::to_string(received.gaps.size()) + " gaps";
}

/// No reads for a while: a link that waits for its reader loses nothing; any other loses sticks and
/// continues.
std::string overrun(const ConformanceFixture& fixture) {
  BoardSession session(fixture, 4);
  session.board.start();
  const bool waits = session.board.capabilities().waits_for_reader;
  const auto until = hw::HostClock::now() + std::chrono::seconds(waits ? 1 : 5);
  const auto enough = [&] {
    return session.board.account().lost.ring_full >= 50 ||
           (waits && session.board.free_slots() == 0) ||
           session.board.state() == hw::BoardState::lost;
  };
  while (!enough() && hw::HostClock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  Received received;
  session.receive(received, 100);
  require_contiguous(received);
  require_balanced(session.board.account());
  const std::uint64_t lost = session.board.account().lost.ring_full;
  if (waits) {
    require(lost == 0,
            "the link waits for its reader, and " + std::to_string(lost) +
                " sticks found the ring full");
    if (!fixture.faulty) require(received.gaps.empty(), "the link waits for its reader, and loses");
    return "it waited";
  }
  if (lost == 0) throw CheckSkipped("the stream was over before the ring was full");
  bool reported = false;
  for (const hw::Gap& gap : received.gaps) reported |= gap.cause == hw::LossCause::ring_full;
  require(reported, "sticks found the ring full, and no gap says so");
  require(session.board.state() != hw::BoardState::lost || fixture.faulty, "an overrun was fatal");
  return std::to_string(lost) + " sticks counted as ring_full, and the stream went on";
}

/// Damage loses the packets concerned, and never ends the stream.
std::string damage_is_not_fatal(const ConformanceFixture& fixture) {
  BoardSession session(with_faults(fixture, "corrupt:0.1+seed:3"));
  session.board.start();
  Received received;
  session.receive(received, kAccountSticks / 2);
  require_contiguous(received);
  require_balanced(session.board.account());
  require(!received.lost || fixture.faulty, "damage ended the stream: " + received.end_reason);
  const auto account = session.board.account();
  if (account.emitted < 50) throw CheckSkipped("needs 50 sticks; " + received.end_reason);
  require(account.lost.corrupt > 0, "a tenth of the packets was damaged, none counted corrupt");
  return std::to_string(account.lost.corrupt) + " corrupt of " + std::to_string(account.emitted);
}

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

std::vector<ConformanceCheck> account_checks() {
  return {
      {"account.balanced", "emitted = delivered + lost, at any time", balanced},
      {"account.seamless", "Where sticks are missing a gap stands, and is counted", contiguous},
      {"account.overrun", "A full ring is counted and reported, and never fatal", overrun},
      {"errors.damage", "Damage costs what it touches and ends nothing", damage_is_not_fatal},
  };
}

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
