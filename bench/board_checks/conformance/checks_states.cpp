// Rule 1: states, and calls that a state does not allow. Rule 8: threads.
#include <algorithm>
#include <mutex>
#include <thread>

#include "bench/board_checks/conformance/board_session.h"
#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

namespace {

using hw::BoardState;

std::string before_start(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  require(session.board.state() == BoardState::open, "a new board is not open");
  require_illegal(
      session.board, "next() before start()", [&] { session.board.next(hw::HostTime::min()); });
  session.board.stop();
  require(session.board.state() == BoardState::open, "stop() before start() changes the state");
  return "refused";
}

std::string start_twice(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  if (session.board.state() == BoardState::lost) throw CheckSkipped("the device is lost at once");
  try {
    require_illegal(session.board, "start() while running", [&] { session.board.start(); });
  } catch (const CheckFailed&) {
    if (session.board.state() == BoardState::lost)
      throw CheckSkipped("the device was lost meanwhile");
    throw;
  }
  return "refused";
}

std::string stop_twice(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  session.receive_all(5);
  session.board.stop();
  const BoardState state = session.board.state();
  require(state == BoardState::configured || state == BoardState::lost,
          "stop() leaves the board neither configured nor lost");
  try {
    session.board.stop();
  } catch (const std::exception& error) {
    throw CheckFailed(std::string("a second stop() throws: ") + error.what());
  }
  require(session.board.state() == state, "a second stop() changes the state");
  return "stopped twice";
}

std::string after_close(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  session.board.close();
  session.board.close();
  require(session.board.state() == BoardState::closed, "close() does not close");
  require_illegal(session.board, "start() after close()", [&] { session.board.start(); });
  require_illegal(
      session.board, "next() after close()", [&] { session.board.next(hw::HostTime::min()); });
  session.board.stop();
  session.board.cancel();
  require(session.board.state() == BoardState::closed, "a closed board comes back");
  return "refused";
}

/// Continues after a stop: in order, nothing twice, and nothing lost if the link waits for its
/// reader.
std::string restart(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  Received received;
  for (std::size_t part = 1; part <= 5; ++part) {
    session.receive(received, 20 * part);
    if (received.over) break;
    session.board.stop();
    if (session.board.state() == BoardState::lost) break;
    session.board.start();
  }
  for (std::size_t i = 1; i < received.order.size(); ++i) {
    require(received.order[i].first == received.order[i - 1].first + received.order[i - 1].count,
            "after a restart stick " + std::to_string(received.order[i].first) + " follows " +
                std::to_string(received.order[i - 1].first));
  }
  if (session.board.capabilities().waits_for_reader && !fixture.faulty) {
    require(received.gaps.empty(), "a restart loses sticks of a link that waits");
  }
  if (received.sticks.size() < 40) throw CheckSkipped(received.end_reason + " before a restart");
  return std::to_string(received.sticks.size()) + " sticks over 4 restarts";
}

std::string shared_among_threads(const ConformanceFixture& fixture) {
  constexpr std::size_t kSticks = 300;
  BoardSession session(fixture, 64);
  session.board.start();
  std::mutex mutex;
  std::vector<std::uint64_t> sequences;
  bool starved = false;
  const auto receive = [&] {
    for (;;) {
      hw::Event event = session.board.next(event_deadline());
      Received received;
      const bool more = record_event(event, received);
      std::lock_guard lock(mutex);
      for (const ReceivedStick& stick : received.sticks) sequences.push_back(stick.sequence);
      if (!more && !received.over) starved = true;
      if (!more || sequences.size() >= kSticks) return;
    }
  };
  std::jthread other(receive);
  receive();
  other.join();
  require(!starved, "two threads share the events, and one waits in vain");
  std::sort(sequences.begin(), sequences.end());
  require(std::adjacent_find(sequences.begin(), sequences.end()) == sequences.end(),
          "two threads were given the same stick");
  // What is delivered was received or is still queued.
  const auto delivered = session.board.account().delivered;
  require(sequences.size() <= delivered, "more sticks were seen than delivered");
  return std::to_string(sequences.size()) + " sticks shared by two threads";
}

}  // namespace

std::vector<ConformanceCheck> state_checks() {
  return {
      {"states.before_start", "A call that the state does not allow changes nothing", before_start},
      {"states.start_twice", "start() while running is an illegal call", start_twice},
      {"states.stop_twice", "stop() may be repeated", stop_twice},
      {"states.after_close", "closed is terminal", after_close},
      {"states.restart", "start() after stop() goes on where it broke off", restart},
      {"threads.shared",
       "Any thread may call next(); each event is given once",
       shared_among_threads},
  };
}

}  // namespace wobblebench::bench
