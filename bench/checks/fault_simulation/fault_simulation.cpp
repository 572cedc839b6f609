#include "bench/checks/fault_simulation/fault_simulation.h"

#include <memory>
#include <optional>

#include "bench/checks/fault_simulation/oracle.h"
#include "bench/checks/fault_simulation/scenario.h"
#include "bench/pipeline/synthetic_sticks.h"
#include "hw/board/board.h"
#include "hw/board/volume_assembly.h"
#include "hw/link/fault_link.h"

namespace wobblebench::bench {

namespace {

/// Far more than any scenario takes; only one that hangs reaches it.
constexpr std::uint64_t kMostSteps = 2'000'000;

class VirtualTime : public hw::HostTimeSource {
 public:
  hw::HostTime now() const override { return now_; }
  void pass(hw::HostClock::duration duration) { now_ += duration; }

 private:
  hw::HostTime now_{};
};

enum class Actor { device, board, program, interruption };

/// One play of one scenario.
class Play {
 public:
  Play(const Scenario& scenario, const Oracle::Trace& trace)
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
      while (!over_) {
        act();
        oracle_.account(board_.account());
        if (++result.steps == kMostSteps) throw RuleBroken("it does not come to an end");
      }
      if (!scenario_.into_volumes) oracle_.explain(link_->events(), figures_->packets_dropped);
      oracle_.seen_all(board_.account());
      check_known(board_.account());
    } catch (const RuleBroken& broken) {
      result.failure = broken.what();
    }
    result.hash = oracle_.hash();
    result.device_time_s = std::chrono::duration<double>(time_.now().time_since_epoch()).count();
    result.sticks_emitted = figures_->sticks_emitted;
    result.acquired_s =
        static_cast<double>(result.sticks_emitted) * scenario_.plan.stick_period_s();
    result.account = board_.account();
    return result;
  }

 private:
  void act() {
    const Actor actor = draw_actor();
    oracle_.step(static_cast<int>(actor));
    switch (actor) {
      case Actor::device:
        time_.pass(std::chrono::microseconds(draws_.between(0, 4000)));
        break;
      case Actor::board:
        if (board_.state() == hw::BoardState::running) board_.step();
        break;
      case Actor::program:
        scenario_.into_volumes ? take_volume() : take_events();
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
    for (int i = 0; i < most && !over_; ++i) {
      const hw::Event event = board_.next(hw::HostTime::min());
      if (std::holds_alternative<hw::TimedOut>(event)) return;
      over_ = !oracle_.event(event);
    }
  }

  void take_volume() {
    if (const auto volume = assembly_.next(hw::HostTime::min())) oracle_.volume(*volume);
    // Stopped is no end: it is started again.
    over_ = assembly_.ended() && board_.state() != hw::BoardState::configured &&
            board_.state() != hw::BoardState::open;
  }

  void interrupt() {
    if (board_.state() == hw::BoardState::lost) return;
    draws_.chance(0.5) ? board_.stop() : board_.cancel();
    board_.start();
  }

  /// The board knows of no stick that the probe did not send.
  void check_known(const hw::BoardAccount& account) const {
    if (account.emitted <= figures_->sticks_emitted) return;
    throw RuleBroken("the board knows of " + std::to_string(account.emitted) +
                     " sticks, sent were " + std::to_string(figures_->sticks_emitted));
  }

  const Scenario& scenario_;
  VirtualTime time_;
  Oracle oracle_;
  Draws draws_;
  std::shared_ptr<sim::SimLinkStatistics> figures_ = std::make_shared<sim::SimLinkStatistics>();
  hw::FaultLink* link_;  ///< the board's
  hw::Board board_;
  hw::VolumeAssembly assembly_;
  bool over_ = false;
};

}  // namespace

FaultSimulationResult simulate_faults(std::uint64_t seed,
                                      const std::function<void(const std::string&)>& trace) {
  const Scenario scenario = draw_scenario(seed);
  if (trace) trace(scenario.text());
  return Play(scenario, trace).run();
}

}  // namespace wobblebench::bench
