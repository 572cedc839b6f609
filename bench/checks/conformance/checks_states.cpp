// Rule 1: states, and calls that a state does not allow. Rule 8: threads.
#include <algorithm>
#include <mutex>
#include <thread>

#include "bench/checks/conformance/suite.h"
#include "bench/checks/conformance/trial.h"

namespace wobblebench::bench {

namespace {

using hw::BoardState;

std::string before_start(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  require(trial.board.state() == BoardState::open, "a new board is not open");
  require_illegal(
      trial.board, "next() before start()", [&] { trial.board.next(hw::HostTime::min()); });
  trial.board.stop();
  require(trial.board.state() == BoardState::open, "stop() before start() changes the state");
  return "refused";
}

std::string start_twice(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  if (trial.board.state() == BoardState::lost) throw CheckSkipped("the device is lost at once");
  try {
    require_illegal(trial.board, "start() while running", [&] { trial.board.start(); });
  } catch (const CheckFailed&) {
    if (trial.board.state() == BoardState::lost)
      throw CheckSkipped("the device was lost meanwhile");
    throw;
  }
  return "refused";
}

std::string stop_twice(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  trial.take_all_of(5);
  trial.board.stop();
  const BoardState state = trial.board.state();
  require(state == BoardState::configured || state == BoardState::lost,
          "stop() leaves the board neither configured nor lost");
  try {
    trial.board.stop();
  } catch (const std::exception& error) {
    throw CheckFailed(std::string("a second stop() throws: ") + error.what());
  }
  require(trial.board.state() == state, "a second stop() changes the state");
  return "stopped twice";
}

std::string after_close(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  trial.board.close();
  trial.board.close();
  require(trial.board.state() == BoardState::closed, "close() does not close");
  require_illegal(trial.board, "start() after close()", [&] { trial.board.start(); });
  require_illegal(
      trial.board, "next() after close()", [&] { trial.board.next(hw::HostTime::min()); });
  trial.board.stop();
  trial.board.cancel();
  require(trial.board.state() == BoardState::closed, "a closed board comes back");
  return "refused";
}

/// Goes on after a stop: in order, nothing twice, and with nothing lost where the link waits.
std::string restart(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  for (std::size_t part = 1; part <= 5; ++part) {
    trial.take(taken, 20 * part);
    if (taken.over) break;
    trial.board.stop();
    if (trial.board.state() == BoardState::lost) break;
    trial.board.start();
  }
  for (std::size_t i = 1; i < taken.order.size(); ++i) {
    require(taken.order[i].first == taken.order[i - 1].first + taken.order[i - 1].count,
            "after a restart stick " + std::to_string(taken.order[i].first) + " follows " +
                std::to_string(taken.order[i - 1].first));
  }
  if (trial.board.capabilities().waits_for_reader && !fixture.faulty) {
    require(taken.gaps.empty(), "a restart loses sticks of a link that waits");
  }
  if (taken.sticks.size() < 40) throw CheckSkipped(taken.what_ended_it + " before a restart");
  return std::to_string(taken.sticks.size()) + " sticks over 4 restarts";
}

std::string shared_among_threads(const ConformanceFixture& fixture) {
  constexpr std::size_t kSticks = 300;
  Trial trial(fixture, 64);
  trial.board.start();
  std::mutex mutex;
  std::vector<std::uint64_t> sequences;
  bool silent = false;
  const auto take = [&] {
    for (;;) {
      hw::Event event = trial.board.next(soon());
      Taken taken;
      const bool more = note(event, taken);
      std::lock_guard lock(mutex);
      for (const TakenStick& stick : taken.sticks) sequences.push_back(stick.sequence);
      if (!more && !taken.over) silent = true;
      if (!more || sequences.size() >= kSticks) return;
    }
  };
  std::thread other(take);
  take();
  other.join();
  require(!silent, "two threads share the events, and one waits in vain");
  std::sort(sequences.begin(), sequences.end());
  require(std::adjacent_find(sequences.begin(), sequences.end()) == sequences.end(),
          "two threads were given the same stick");
  // Both threads have taken all that they began to: what is delivered was seen or still waits.
  const auto delivered = trial.board.account().delivered;
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
