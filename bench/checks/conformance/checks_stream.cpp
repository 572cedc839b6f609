// What comes over the link is what the plan says: the wire format's rules, and no stale data.
#include <algorithm>
#include <map>

#include "bench/checks/conformance/suite.h"
#include "bench/checks/conformance/trial.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kSticks = 600;

Taken take(const ConformanceFixture& fixture, std::size_t sticks = kSticks) {
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  trial.take(taken, sticks);
  return taken;
}

const hw::AcquisitionPlan& plan_of(const Taken& taken) {
  if (taken.configurations.empty()) {
    require(taken.over, "no configuration came");
    throw CheckSkipped("needs a configuration; " + taken.what_ended_it);
  }
  return taken.configurations.front().plan;
}

std::string configured_first(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  while (taken.configurations.empty() && !taken.over) {
    hw::Event event = trial.board.next(soon());
    if (!note(event, taken)) require(taken.over, "no configuration came");
    require(taken.sticks.empty(), "a stick is delivered before any configuration");
  }
  plan_of(taken);
  require(taken.gaps.empty() || fixture.faulty || !fixture.repeatable,
          "sticks came before the first configuration");
  return "a configuration comes before the first stick";
}

std::string fits_the_plan(const ConformanceFixture& fixture) {
  const Taken taken = take(fixture);
  const hw::AcquisitionPlan& plan = plan_of(taken);
  const auto samples = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  for (const TakenStick& stick : taken.sticks) {
    require(stick.index == plan.index(stick.sequence),
            "stick " + std::to_string(stick.sequence) + " has another stick's index");
    require(stick.samples == samples, "a stick of " + std::to_string(stick.samples) + " samples");
  }
  return std::to_string(taken.sticks.size()) + " sticks have index and samples of the plan";
}

std::string times_grow(const ConformanceFixture& fixture) {
  const Taken taken = take(fixture);
  for (std::size_t i = 1; i < taken.sticks.size(); ++i) {
    require(taken.sticks[i].time > taken.sticks[i - 1].time,
            "stick " + std::to_string(taken.sticks[i].sequence) + " was fired before stick " +
                std::to_string(taken.sticks[i - 1].sequence));
  }
  return std::to_string(taken.sticks.size()) + " device times grow";
}

/// No bytes that belong to no packet, nothing late, nothing twice.
std::string undamaged(const ConformanceFixture& fixture) {
  if (fixture.faulty) throw CheckSkipped("faults damage it on purpose");
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  trial.take(taken, kSticks);
  const auto account = trial.board.account();
  require(account.lost.corrupt == 0,
          std::to_string(account.lost.corrupt) + " sticks were corrupt on a link without faults");
  require(account.lost.out_of_order + account.duplicates == 0, "sticks came late or twice");
  return std::to_string(taken.sticks.size()) + " sticks, none corrupt, late or repeated";
}

std::string volumes_end(const ConformanceFixture& fixture) {
  if (fixture.faulty) throw CheckSkipped("faults drop ends on purpose");
  Trial trial(fixture);
  trial.board.start();
  Taken taken;
  trial.take(taken, 1);
  const auto per_volume = static_cast<std::size_t>(plan_of(taken).sticks_per_volume());
  if (per_volume > 10000) throw CheckSkipped("a volume of more than 10 000 sticks");
  trial.take(taken, 2 * per_volume);
  if (taken.sticks.back().index.volume == taken.sticks.front().index.volume && !taken.over) {
    throw CheckSkipped("needs the end of a volume");
  }
  require(!taken.ends.empty(), "a volume ended without a volume end");
  return std::to_string(taken.ends.size()) + " volume ends";
}

/// A second opening gives the same sticks: none is made of old bytes.
std::string not_stale(const ConformanceFixture& fixture) {
  if (!fixture.repeatable) throw CheckSkipped("the source does not repeat itself");
  std::map<std::uint64_t, std::uint64_t> first;
  for (const TakenStick& stick : take(fixture).sticks) first[stick.sequence] = stick.fingerprint;
  std::size_t same = 0;
  for (const TakenStick& stick : take(fixture).sticks) {
    const auto found = first.find(stick.sequence);
    if (found == first.end()) continue;
    require(found->second == stick.fingerprint,
            "stick " + std::to_string(stick.sequence) + " differs from itself");
    ++same;
  }
  if (same == 0) throw CheckSkipped("the two openings share no stick");
  return std::to_string(same) + " sticks bit for bit the same when opened again";
}

/// Different sticks of a live source hold different noise.
std::string not_repeated(const ConformanceFixture& fixture) {
  Trial trial(fixture);
  trial.board.start();
  std::map<std::vector<float>, std::uint64_t> seen;
  for (int i = 0; i < 64; ++i) {
    const hw::StickSlot slot = trial.take_slot();
    const bool blank =
        std::adjacent_find(slot->samples.begin(), slot->samples.end(), std::not_equal_to<>()) ==
        slot->samples.end();
    if (blank) continue;
    const auto [before, fresh] = seen.emplace(slot->samples, slot->sequence);
    require(fresh,
            "stick " + std::to_string(slot->sequence) + " holds the samples of stick " +
                std::to_string(before->second));
  }
  return "64 sticks, no two alike";
}

}  // namespace

std::vector<ConformanceCheck> stream_checks() {
  return {
      {"stream.configured", "A configuration comes before the first stick", configured_first},
      {"stream.plan", "Index and samples of each stick are the plan's", fits_the_plan},
      {"stream.times", "Device times grow", times_grow},
      {"stream.undamaged", "A link without faults damages nothing", undamaged},
      {"stream.volume_end", "A volume that ends says so", volumes_end},
      {"stream.stale", "Old bytes are never delivered as new data", not_repeated},
      {"stream.same", "What repeats itself gives the same sticks again", not_stale},
  };
}

}  // namespace wobblebench::bench
