#include "bench/board_checks/fault_simulation/fault_simulation.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "base/duration.h"
#include "bench/board_checks/fault_simulation/oracle.h"
#include "bench/board_checks/fault_simulation/recording_simulation.h"
#include "bench/board_checks/fault_simulation/scenario.h"
#include "bench/pipeline/stick_sources.h"
#include "bench/results/counts.h"
#include "hw/board/board.h"
#include "hw/board/volume_assembly.h"
#include "hw/link/fault_link.h"

namespace wobblebench::bench {

namespace {

/// Far more than any scenario takes; only one that hangs reaches it.
constexpr std::uint64_t kMostSteps = 2'000'000;

enum class Actor { device, board, program, interruption };

/// Runs one scenario.
class Simulation {
 public:
  Simulation(const Scenario& scenario, const Oracle::Trace& trace)
      : scenario_(scenario),
        oracle_(scenario, trace),
        draws_(~scenario.seed),
        link_(new hw::FaultLink(
            std::make_unique<sim::SimLink>(
                synthetic_sticks(scenario.plan, scenario.seed), scenario.link, figures_, &time_),
            scenario.faults,
            &time_)),
        board_(std::unique_ptr<hw::Link>(link_),
               {.ring_slots = scenario.ring_slots, .reader = hw::ReaderMode::stepped}),
        assembly_(board_) {}

  FaultSimulationResult run() {
    FaultSimulationResult result{.seed = scenario_.seed};
    try {
      board_.start();
      while (!ended_) {
        act();
        oracle_.check_account(board_.account());
        if (++result.steps == kMostSteps) throw RuleViolation("it does not come to an end");
      }
      if (!scenario_.assemble_volumes)
        oracle_.check_losses(link_->events(), figures_->packets_dropped);
      oracle_.check_all_received(board_.account());
      check_emitted(board_.account());
    } catch (const RuleViolation& broken) {
      result.failure = broken.what();
    }
    result.hash = oracle_.hash();
    result.device_time_s = to_seconds(time_.now().time_since_epoch());
    result.sticks_emitted = figures_->sticks_emitted;
    result.acquired_s =
        static_cast<double>(result.sticks_emitted) * scenario_.plan.stick_period_s();
    result.account = board_.account();
    return result;
  }

 private:
  void act() {
    const Actor actor = draw_actor();
    oracle_.add_action(static_cast<int>(actor));
    switch (actor) {
      case Actor::device:
        time_.advance(std::chrono::microseconds(draws_.between(0, 4000)));
        break;
      case Actor::board:
        if (board_.state() == hw::BoardState::running) board_.step();
        break;
      case Actor::program:
        scenario_.assemble_volumes ? take_volume() : take_events();
        break;
      case Actor::interruption:
        interrupt();
        break;
    }
  }

  Actor draw_actor() {
    if (draws_.chance(scenario_.interruptions)) return Actor::interruption;
    const double at = draws_.uniform() * (scenario_.device + scenario_.board + scenario_.program);
    if (at < scenario_.device) return Actor::device;
    return at < scenario_.device + scenario_.board ? Actor::board : Actor::program;
  }

  void take_events() {
    const int most = draws_.between(1, 40);
    for (int i = 0; i < most && !ended_; ++i) {
      const hw::Event event = board_.next(hw::HostTime::min());
      if (std::holds_alternative<hw::TimedOut>(event)) return;
      ended_ = !oracle_.check_event(event);
    }
  }

  void take_volume() {
    if (const auto volume = assembly_.next(hw::HostTime::min())) oracle_.check_volume(*volume);
    // A stopped board is started again.
    ended_ = assembly_.ended() && board_.state() != hw::BoardState::configured &&
             board_.state() != hw::BoardState::open;
  }

  void interrupt() {
    if (board_.state() == hw::BoardState::lost) return;
    draws_.chance(0.5) ? board_.stop() : board_.cancel();
    board_.start();
  }

  /// The board counts no stick that the probe did not send.
  void check_emitted(const hw::BoardAccount& account) const {
    if (account.emitted <= figures_->sticks_emitted) return;
    throw RuleViolation("the board knows of " + std::to_string(account.emitted) +
                        " sticks, sent were " + std::to_string(figures_->sticks_emitted));
  }

  const Scenario& scenario_;
  VirtualTime time_;
  Oracle oracle_;
  Draws draws_;
  std::shared_ptr<sim::SimLinkStatistics> figures_ = std::make_shared<sim::SimLinkStatistics>();
  hw::FaultLink* link_;  ///< owned by board_
  hw::Board board_;
  hw::VolumeAssembly assembly_;
  bool ended_ = false;
};

/// Seeds that are simulated together: what they return is kept until they are added up.
constexpr int kBlock = 4096;

void add(SeedRangeResult& all, EventHash& hash, FaultSimulationResult&& result) {
  hash.add(result.hash);
  all.device_time_s += result.device_time_s;
  all.acquired_s += result.acquired_s;
  all.steps += result.steps;
  all.sticks += result.sticks_emitted;
  add_account(result.account, all.account);
  all.bytes_recorded += result.bytes_recorded;
  all.sticks_salvaged += result.sticks_salvaged;
  if (!result.failure.empty()) all.failed.push_back(std::move(result));
}

}  // namespace

FaultSimulationResult simulate_faults(std::uint64_t seed,
                                      const std::function<void(const std::string&)>& trace) {
  const Scenario scenario = draw_scenario(seed);
  if (trace) trace(scenario.text());
  FaultSimulationResult result = Simulation(scenario, trace).run();
  if (!result.failure.empty()) return result;
  const RecordingSimulationResult recorded = simulate_recording(scenario, trace);
  EventHash hash;
  hash.add(result.hash);
  hash.add(recorded.hash);
  result.hash = hash.value();
  result.bytes_recorded = recorded.bytes_recorded;
  result.sticks_salvaged = recorded.sticks_salvaged;
  result.failure = recorded.failure;
  return result;
}

SeedRangeResult simulate_seeds(std::uint64_t first_seed, int seeds, const PartDone& done) {
  const auto start = hw::HostClock::now();
  std::atomic<std::size_t> finished = 0;
  SeedRangeResult all{.first_seed = first_seed, .seeds = seeds};
  EventHash hash;
  for (int first = 0; first < seeds; first += kBlock) {
    std::vector<FaultSimulationResult> block(
        static_cast<std::size_t>(std::min(kBlock, seeds - first)));
    tbb::parallel_for(std::size_t{0}, block.size(), [&](std::size_t i) {
      block[i] = simulate_faults(first_seed + static_cast<std::uint64_t>(first) + i);
      const std::size_t count = ++finished;
      if (done) done(count, static_cast<std::size_t>(seeds));
    });
    for (FaultSimulationResult& result : block) add(all, hash, std::move(result));
  }
  all.wall_s = 1e-3 * to_milliseconds(hw::HostClock::now() - start);
  all.hash = hash.value();
  return all;
}

}  // namespace wobblebench::bench
