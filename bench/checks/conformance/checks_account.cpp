// Rule 3: every stick is delivered or counted lost, by its cause. Rule 4: what is no end.
#include <thread>

#include "bench/checks/conformance/board_fixture.h"
#include "bench/checks/conformance/suite.h"
#include "bench/checks/conformance/trial.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kSticks = 400;

std::string numbers(const hw::BoardAccount& account) {
  return "emitted " + std::to_string(account.emitted) + ", delivered " +
         std::to_string(account.delivered) + ", lost " + std::to_string(account.lost.total());
}

void require_balanced(const hw::BoardAccount& account) {
  require(account.balanced(), numbers(account));
}

std::string balanced(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  while (taken.sticks.size() < kSticks && !taken.over) {
    trial.take(taken, taken.sticks.size() + 1);
    require_balanced(trial.board.account());
  }
  trial.board.stop();
  require_balanced(trial.board.account());
  return numbers(trial.board.account());
}

/// Sticks and gaps, in order, name every number from the first to the last once.
void require_seamless(const Taken& taken) {
  for (std::size_t i = 1; i < taken.order.size(); ++i) {
    const auto& before = taken.order[i - 1];
    require(taken.order[i].first == before.first + before.count,
            "after " + std::to_string(before.first + before.count - 1) + " comes " +
                std::to_string(taken.order[i].first) + " with no gap reported");
  }
}

std::string seamless(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  trial.take(taken, kSticks);
  require_seamless(taken);
  std::uint64_t missing = 0;
  for (const hw::Gap& gap : taken.gaps) missing += gap.count;
  trial.board.stop();
  require(trial.board.account().lost.total() >= missing, "a gap was reported and not counted");
  return std::to_string(taken.sticks.size()) + " sticks, " + std::to_string(taken.gaps.size()) +
         " gaps";
}

/// Nobody reads for a while: a link that waits loses nothing; any other loses, and goes on.
std::string overrun(const ConformanceFixture& fixture) {
  Trial trial(fixture, 4);
  trial.board.start();
  const bool waits = trial.board.capabilities().waits_for_reader;
  const auto until = hw::HostClock::now() + std::chrono::seconds(waits ? 1 : 5);
  const auto enough = [&] {
    return trial.board.account().lost.ring_full >= 50 || (waits && trial.board.free_slots() == 0) ||
           trial.board.state() == hw::BoardState::lost;
  };
  while (!enough() && hw::HostClock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  Taken taken;
  trial.take(taken, 100);
  require_seamless(taken);
  require_balanced(trial.board.account());
  const std::uint64_t lost = trial.board.account().lost.ring_full;
  if (waits) {
    require(lost == 0,
            "the link waits for its reader, and " + std::to_string(lost) +
                " sticks found the ring full");
    if (!fixture.faulty) require(taken.gaps.empty(), "the link waits for its reader, and loses");
    return "it waited";
  }
  if (lost == 0) throw CheckSkipped("the stream was over before the ring was full");
  bool reported = false;
  for (const hw::Gap& gap : taken.gaps) reported |= gap.cause == hw::LossCause::ring_full;
  require(reported, "sticks found the ring full, and no gap says so");
  require(trial.board.state() != hw::BoardState::lost || fixture.faulty, "an overrun was fatal");
  return std::to_string(lost) + " sticks counted as ring_full, and the stream went on";
}

/// Damage on the way costs what it touches, and never ends the stream.
std::string damage_is_not_fatal(const ConformanceFixture& fixture) {
  Trial trial(with_faults(fixture, "corrupt:0.1+seed:3"));
  trial.board.start();
  Taken taken;
  trial.take(taken, kSticks / 2);
  require_seamless(taken);
  require_balanced(trial.board.account());
  require(!taken.lost || fixture.faulty, "damage ended the stream: " + taken.what_ended_it);
  const auto account = trial.board.account();
  if (account.emitted < 50) throw CheckSkipped("needs 50 sticks; " + taken.what_ended_it);
  require(account.lost.corrupt > 0, "a tenth of the packets was damaged, none counted corrupt");
  return std::to_string(account.lost.corrupt) + " corrupt of " + std::to_string(account.emitted);
}

}  // namespace

std::vector<ConformanceCheck> account_checks() {
  return {
      {"account.balanced", "emitted = delivered + lost, at any time", balanced},
      {"account.seamless", "Where sticks are missing a gap stands, and is counted", seamless},
      {"account.overrun", "A full ring is counted and reported, and never fatal", overrun},
      {"errors.damage", "Damage costs what it touches and ends nothing", damage_is_not_fatal},
  };
}

}  // namespace wobblebench::bench
