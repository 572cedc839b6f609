// Rules 5 to 7: deadlines, cancelling, unplugging.
#include <algorithm>
#include <atomic>
#include <thread>

#include "base/duration.h"
#include "base/statistics.h"
#include "bench/board_checks/conformance/board_session.h"
#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

namespace {

using std::chrono::milliseconds;

/// The contract's bound on a wake-up is 10 ms; the scheduler of a busy machine may add to it.
constexpr milliseconds kWakeUp{10};
constexpr milliseconds kSchedulingNoise{90};
constexpr int kCancels = 9;

double ms_since(hw::HostTime start) {
  return to_milliseconds(hw::HostClock::now() - start);
}

std::string in_ms(double value) {
  return std::to_string(static_cast<int>(value)) + " ms";
}

/// The link sends nothing for a minute.
ConformanceFixture silent_line(const ConformanceFixture& fixture) {
  return with_faults(fixture, "stall@0+stall_ms:60000");
}

std::string poll(const ConformanceFixture& fixture) {
  BoardSession session(silent_line(fixture));
  session.board.start();
  const auto start = hw::HostClock::now();
  for (int i = 0; i < 200; ++i) {
    const hw::Event event = session.board.next(hw::HostTime::min());
    if (!std::holds_alternative<hw::TimedOut>(event)) throw CheckSkipped("the line is not silent");
  }
  require(ms_since(start) < 200 * 10, "200 polls took " + in_ms(ms_since(start)));
  return "200 polls of a silent line did not wait";
}

std::string deadline(const ConformanceFixture& fixture) {
  BoardSession session(silent_line(fixture));
  session.board.start();
  double latest = 0;
  for (const int wait : {5, 20, 60}) {
    const auto start = hw::HostClock::now();
    const hw::Event event = session.board.next(start + milliseconds(wait));
    if (!std::holds_alternative<hw::TimedOut>(event)) throw CheckSkipped("the line is not silent");
    require(hw::HostClock::now() >= start + milliseconds(wait), "it gave up before the deadline");
    latest = std::max(latest, ms_since(start) - wait);
  }
  require(latest < 100, "it gave up " + in_ms(latest) + " after the deadline");
  return "deadlines of 5, 20 and 60 ms kept";
}

std::string pending_first(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  for (const auto until = event_deadline();
       session.board.account().delivered == 0 && hw::HostClock::now() < until;) {
    if (session.board.state() == hw::BoardState::lost) throw CheckSkipped("the device is lost");
    std::this_thread::sleep_for(milliseconds(1));
  }
  session.board.stop();
  Received received;
  for (;;) {
    hw::Event event = session.board.next(hw::HostTime::min());
    if (!record_event(event, received)) break;
  }
  if (session.board.account().delivered == 0) throw CheckSkipped("no stick came");
  require(received.sticks.size() == session.board.account().delivered,
          "a deadline in the past hides what is there");
  return std::to_string(received.sticks.size()) + " waiting sticks given without waiting";
}

/// Wall time from cancel() to the return of a waiting next(), median of several.
std::string cancel_wakes(const ConformanceFixture& fixture) {
  BoardSession session(silent_line(fixture));
  std::vector<double> waking_ms;
  for (int i = 0; i < kCancels; ++i) {
    session.board.start();
    std::atomic<bool> cancelled_event = false;
    hw::HostTime woken;
    std::jthread waiter([&] {
      const hw::Event event = session.board.next(event_deadline());
      woken = hw::HostClock::now();
      cancelled_event = std::holds_alternative<hw::Cancelled>(event);
    });
    std::this_thread::sleep_for(milliseconds(2));
    const auto cancelled = hw::HostClock::now();
    session.board.cancel();
    waiter.join();
    require(cancelled_event, "a cancelled waiter is not told so");
    waking_ms.push_back(to_milliseconds(woken - cancelled));
    session.board.stop();
  }
  const double median = quantile(waking_ms, 0.5);
  require(median <= kWakeUp.count(), "a waiter wakes " + in_ms(median) + " after cancel()");
  return "woken within 10 ms, median of " + std::to_string(kCancels);
}

std::string cancel_goes_on(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  Received received;
  for (std::size_t part = 1; part <= 10; ++part) {
    session.receive(received, 10 * part);
    if (received.over) break;
    session.board.cancel();
    session.board.cancel();
    const hw::Event event = session.board.next(event_deadline());
    require(std::holds_alternative<hw::Cancelled>(event), "after cancel() something else comes");
    const auto start = hw::HostClock::now();
    if (session.board.state() == hw::BoardState::lost) break;
    try {
      session.board.start();
    } catch (const hw::IllegalBoardCall&) {
      // The device was lost between the two calls.
      require(session.board.state() == hw::BoardState::lost, "start() after cancel() is refused");
      break;
    }
    require(ms_since(start) < 1000, "a restart took " + in_ms(ms_since(start)));
  }
  for (std::size_t i = 1; i < received.order.size(); ++i) {
    require(received.order[i].first == received.order[i - 1].first + received.order[i - 1].count,
            "cancelling lost or repeated a stick in silence");
  }
  if (session.board.capabilities().waits_for_reader && !fixture.faulty) {
    require(received.gaps.empty(), "cancelling loses sticks of a link that waits");
  }
  if (received.sticks.size() < 20) throw CheckSkipped(received.end_reason + " before a restart");
  return std::to_string(received.sticks.size()) + " sticks over 9 cancels";
}

/// Loses the device, under a waiting next(), and opens it again.
std::string lose_and_reopen(const ConformanceFixture& fixture,
                            const ConformanceFixture& to_be_lost,
                            const std::function<void()>& pull_out) {
  BoardSession session(to_be_lost);
  session.board.start();
  Received received;
  session.receive(received, 10);
  if (pull_out) pull_out();
  session.receive(received, 1000000);
  if (!received.lost && received.sticks.size() < 1000) {
    require(!pull_out, received.end_reason + " when the card was pulled out");
    throw CheckSkipped(received.end_reason + " before the device was lost");
  }
  require(session.board.state() == hw::BoardState::lost, "the device is lost, the board is not");
  const auto start = hw::HostClock::now();
  require(std::holds_alternative<hw::DeviceLost>(session.board.next(event_deadline())),
          "a lost device is forgotten");
  require(ms_since(start) < static_cast<double>((kWakeUp + kSchedulingNoise).count()),
          "a call on a lost device waits");
  require_illegal(session.board, "start() on a lost device", [&] { session.board.start(); });
  require(session.board.account().balanced(), "the account is not balanced after the loss");
  session.board.close();
  if (fixture.replug) fixture.replug();
  BoardSession again(fixture);
  again.board.start();
  Received after;
  again.receive(after, 10);
  require(!after.sticks.empty(), "nothing comes after reopening");
  return "lost after " + std::to_string(received.sticks.size()) + " sticks, told, and reopened";
}

std::string unplugged_on_the_way(const ConformanceFixture& fixture) {
  return lose_and_reopen(fixture, with_faults(fixture, "unplug@40"), {});
}

std::string unplugged(const ConformanceFixture& fixture) {
  if (!fixture.unplug) throw CheckSkipped("nobody can pull this card out");
  return lose_and_reopen(fixture, fixture, fixture.unplug);
}

}  // namespace

std::vector<ConformanceCheck> wait_checks() {
  return {
      {"timeout.poll", "A deadline in the past does not wait", poll},
      {"timeout.pending", "… and still gives what is there", pending_first},
      {"timeout.deadline", "One deadline holds for the whole call", deadline},
      {"cancel.wakes", "cancel() wakes a waiter within 10 ms", cancel_wakes},
      {"cancel.restart", "After cancel() the board starts at once and goes on", cancel_goes_on},
      {"unplug.told", "A lost device is told to waiters and for good", unplugged_on_the_way},
      {"unplug.card", "… also when the card itself is pulled out", unplugged},
  };
}

}  // namespace wobblebench::bench
