// Rules 5 to 7: deadlines, cancelling, unplugging.
#include <algorithm>
#include <atomic>
#include <thread>

#include "bench/checks/conformance/board_fixture.h"
#include "bench/checks/conformance/suite.h"
#include "bench/checks/conformance/trial.h"

namespace wobblebench::bench {

namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

/// The contract's bound on a wake-up is 10 ms; a busy machine may be late by more than the board.
constexpr milliseconds kWakeUp{10};
constexpr milliseconds kSchedulingNoise{90};
constexpr int kCancels = 9;

double ms_since(hw::HostTime start) {
  return duration<double, std::milli>(hw::HostClock::now() - start).count();
}

std::string in_ms(double value) {
  return std::to_string(static_cast<int>(value)) + " ms";
}

/// A line that sends nothing for a minute.
ConformanceFixture silent(const ConformanceFixture& fixture) {
  return with_faults(fixture, "stall@0+stall_ms:60000");
}

std::string poll(const ConformanceFixture& fixture) {
  Trial trial(silent(fixture));
  trial.board.start();
  const auto start = hw::HostClock::now();
  for (int i = 0; i < 200; ++i) {
    const hw::Event event = trial.board.next(hw::HostTime::min());
    if (!std::holds_alternative<hw::TimedOut>(event)) throw CheckSkipped("the line is not silent");
  }
  require(ms_since(start) < 200 * 10, "200 polls took " + in_ms(ms_since(start)));
  return "200 polls of a silent line did not wait";
}

std::string deadline(const ConformanceFixture& fixture) {
  Trial trial(silent(fixture));
  trial.board.start();
  double latest = 0;
  for (const int wait : {5, 20, 60}) {
    const auto start = hw::HostClock::now();
    const hw::Event event = trial.board.next(start + milliseconds(wait));
    if (!std::holds_alternative<hw::TimedOut>(event)) throw CheckSkipped("the line is not silent");
    require(hw::HostClock::now() >= start + milliseconds(wait), "it gave up before the deadline");
    latest = std::max(latest, ms_since(start) - wait);
  }
  require(latest < 100, "it gave up " + in_ms(latest) + " after the deadline");
  return "deadlines of 5, 20 and 60 ms kept";
}

std::string pending_first(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  for (const auto until = soon();
       trial.board.account().delivered == 0 && hw::HostClock::now() < until;) {
    if (trial.board.state() == hw::BoardState::lost) throw CheckSkipped("the device is lost");
    std::this_thread::sleep_for(milliseconds(1));
  }
  trial.board.stop();
  Taken taken;
  for (;;) {
    hw::Event event = trial.board.next(hw::HostTime::min());
    if (!note(event, taken)) break;
  }
  if (trial.board.account().delivered == 0) throw CheckSkipped("no stick came");
  require(taken.sticks.size() == trial.board.account().delivered,
          "a deadline in the past hides what is there");
  return std::to_string(taken.sticks.size()) + " waiting sticks given without waiting";
}

/// Wall time from cancel() to the waiter's waking, the median of several.
std::string cancel_wakes(const ConformanceFixture& fixture) {
  Trial trial(silent(fixture));
  std::vector<double> waking_ms;
  for (int i = 0; i < kCancels; ++i) {
    trial.board.start();
    std::atomic<bool> right = false;
    hw::HostTime woken;
    std::thread waiter([&] {
      const hw::Event event = trial.board.next(soon());
      woken = hw::HostClock::now();
      right = std::holds_alternative<hw::Cancelled>(event);
    });
    std::this_thread::sleep_for(milliseconds(2));
    const auto cancelled = hw::HostClock::now();
    trial.board.cancel();
    waiter.join();
    require(right, "a cancelled waiter is not told so");
    waking_ms.push_back(duration<double, std::milli>(woken - cancelled).count());
    trial.board.stop();
  }
  std::nth_element(waking_ms.begin(), waking_ms.begin() + kCancels / 2, waking_ms.end());
  const double median = waking_ms[kCancels / 2];
  require(median <= kWakeUp.count(), "a waiter wakes " + in_ms(median) + " after cancel()");
  return "woken within 10 ms, median of " + std::to_string(kCancels);
}

std::string cancel_goes_on(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  for (std::size_t part = 1; part <= 10; ++part) {
    trial.take(taken, 10 * part);
    if (taken.over) break;
    trial.board.cancel();
    trial.board.cancel();
    const hw::Event event = trial.board.next(soon());
    require(std::holds_alternative<hw::Cancelled>(event), "after cancel() something else comes");
    const auto start = hw::HostClock::now();
    if (trial.board.state() == hw::BoardState::lost) break;
    try {
      trial.board.start();
    } catch (const hw::IllegalBoardCall&) {
      // The device was lost between the two calls.
      require(trial.board.state() == hw::BoardState::lost, "start() after cancel() is refused");
      break;
    }
    require(ms_since(start) < 1000, "a restart took " + in_ms(ms_since(start)));
  }
  for (std::size_t i = 1; i < taken.order.size(); ++i) {
    require(taken.order[i].first == taken.order[i - 1].first + taken.order[i - 1].count,
            "cancelling lost or repeated a stick in silence");
  }
  if (trial.board.capabilities().waits_for_reader && !fixture.faulty) {
    require(taken.gaps.empty(), "cancelling loses sticks of a link that waits");
  }
  if (taken.sticks.size() < 20) throw CheckSkipped(taken.what_ended_it + " before a restart");
  return std::to_string(taken.sticks.size()) + " sticks over 9 cancels";
}

/// Holds slots, loses the device under a waiter, and opens it anew.
std::string lose_and_reopen(const ConformanceFixture& fixture,
                            const ConformanceFixture& to_be_lost,
                            const std::function<void()>& pull_out) {
  Trial trial(to_be_lost);
  trial.board.start();
  Taken taken;
  trial.take(taken, 10);
  if (pull_out) pull_out();
  trial.take(taken, 1000000);
  if (!taken.lost && taken.sticks.size() < 1000) {
    require(!pull_out, taken.what_ended_it + " when the card was pulled out");
    throw CheckSkipped(taken.what_ended_it + " before the device was lost");
  }
  require(trial.board.state() == hw::BoardState::lost, "the device is lost, the board is not");
  const auto start = hw::HostClock::now();
  require(std::holds_alternative<hw::DeviceLost>(trial.board.next(soon())),
          "a lost device is forgotten");
  require(ms_since(start) < static_cast<double>((kWakeUp + kSchedulingNoise).count()),
          "a call on a lost device waits");
  require_illegal(trial.board, "start() on a lost device", [&] { trial.board.start(); });
  require(trial.board.account().balanced(), "the account is not balanced after the loss");
  trial.board.close();
  if (fixture.replug) fixture.replug();
  Trial again(fixture);
  again.board.start();
  Taken anew;
  again.take(anew, 10);
  require(!anew.sticks.empty(), "nothing comes after reopening");
  return "lost after " + std::to_string(taken.sticks.size()) + " sticks, told, and reopened";
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
