// The stream agrees with the plan and with the rules of the wire format, and holds no stale data.
#include <algorithm>
#include <map>

#include "bench/board_checks/conformance/board_session.h"
#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kStreamSticks = 600;

Received receive(const ConformanceFixture& fixture, std::size_t sticks = kStreamSticks) {
  BoardSession session(fixture);
  session.board.start();
  Received received;
  session.receive(received, sticks);
  return received;
}

const hw::AcquisitionPlan& plan_of(const Received& received) {
  if (received.configurations.empty()) {
    require(received.over, "no configuration came");
    throw CheckSkipped("needs a configuration; " + received.end_reason);
  }
  return received.configurations.front().plan;
}

std::string configured_first(const ConformanceFixture& fixture) {
  BoardSession session(fixture);
  session.board.start();
  Received received;
  while (received.configurations.empty() && !received.over) {
    hw::Event event = session.board.next(event_deadline());
    if (!record_event(event, received)) require(received.over, "no configuration came");
    require(received.sticks.empty(), "a stick is delivered before any configuration");
  }
  plan_of(received);
  require(received.gaps.empty() || fixture.faulty || !fixture.repeatable,
          "sticks came before the first configuration");
  return "a configuration comes before the first stick";
}

std::string fits_the_plan(const ConformanceFixture& fixture) {
  const Received received = receive(fixture);
  const hw::AcquisitionPlan& plan = plan_of(received);
  const auto samples = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  for (const ReceivedStick& stick : received.sticks) {
    require(stick.index == plan.index(stick.sequence),
            "stick " + std::to_string(stick.sequence) + " has another stick's index");
    require(stick.samples == samples, "a stick of " + std::to_string(stick.samples) + " samples");
  }
  return std::to_string(received.sticks.size()) + " sticks have index and samples of the plan";
}

std::string times_grow(const ConformanceFixture& fixture) {
  const Received received = receive(fixture);
  for (std::size_t i = 1; i < received.sticks.size(); ++i) {
    require(received.sticks[i].time > received.sticks[i - 1].time,
            "stick " + std::to_string(received.sticks[i].sequence) + " was fired before stick " +
                std::to_string(received.sticks[i - 1].sequence));
  }
  return std::to_string(received.sticks.size()) + " device times grow";
}

/// No bytes that belong to no packet, nothing late, nothing twice.
std::string undamaged(const ConformanceFixture& fixture) {
  if (fixture.faulty) throw CheckSkipped("faults damage it on purpose");
  BoardSession session(fixture);
  session.board.start();
  Received received;
  session.receive(received, kStreamSticks);
  const auto account = session.board.account();
  require(account.lost.corrupt == 0,
          std::to_string(account.lost.corrupt) + " sticks were corrupt on a link without faults");
  require(account.lost.out_of_order + account.duplicates == 0, "sticks came late or twice");
  return std::to_string(received.sticks.size()) + " sticks, none corrupt, late or repeated";
}

std::string volumes_end(const ConformanceFixture& fixture) {
  if (fixture.faulty) throw CheckSkipped("faults drop ends on purpose");
  BoardSession session(fixture);
  session.board.start();
  Received received;
  session.receive(received, 1);
  const auto per_volume = static_cast<std::size_t>(plan_of(received).sticks_per_volume());
  if (per_volume > 10000) throw CheckSkipped("a volume of more than 10 000 sticks");
  session.receive(received, 2 * per_volume);
  if (received.sticks.back().index.volume == received.sticks.front().index.volume &&
      !received.over) {
    throw CheckSkipped("needs the end of a volume");
  }
  require(!received.ends.empty(), "a volume ended without a volume end");
  return std::to_string(received.ends.size()) + " volume ends";
}

/// A second opening gives the same sticks: none holds old bytes.
std::string not_stale(const ConformanceFixture& fixture) {
  if (!fixture.repeatable) throw CheckSkipped("the source does not repeat itself");
  std::map<std::uint64_t, std::uint64_t> first;
  for (const ReceivedStick& stick : receive(fixture).sticks)
    first[stick.sequence] = stick.fingerprint;
  std::size_t same = 0;
  for (const ReceivedStick& stick : receive(fixture).sticks) {
    const auto found = first.find(stick.sequence);
    if (found == first.end()) continue;
    require(found->second == stick.fingerprint,
            "stick " + std::to_string(stick.sequence) + " differs from itself");
    ++same;
  }
  if (same == 0) throw CheckSkipped("the two openings share no stick");
  return std::to_string(same) + " sticks bit for bit the same when opened again";
}

/// Whether the echoes at both sticks may be the same: a simulation without noise has the symmetry
/// of its scene, about the middle of the sector and of the sweep.
bool may_be_alike(const ReceivedStick& one, const ReceivedStick& other, const Received& received) {
  if (received.configurations.empty()) return false;
  const hw::Configuration& configuration = received.configurations.front();
  const auto mirrored = [](std::uint32_t i, std::uint32_t j, int count) {
    return i == j || i + j + 1 == static_cast<std::uint32_t>(count);
  };
  const hw::AcquisitionOptions& scan = configuration.plan.acquisition();
  return configuration.source == hw::StreamOrigin::simulated &&
         mirrored(one.index.line, other.index.line, scan.sticks_per_frame) &&
         mirrored(one.index.frame, other.index.frame, scan.frames_per_volume);
}

/// Different sticks of a source with noise hold different samples.
std::string not_repeated(const ConformanceFixture& fixture) {
  constexpr std::size_t kCompared = 64;
  BoardSession session(fixture);
  session.board.start();
  Received received;
  std::map<std::vector<float>, ReceivedStick> seen;
  int alike = 0;
  while (received.sticks.size() < kCompared) {
    const std::vector<float> samples = session.receive_slot(received)->samples;
    if (std::ranges::adjacent_find(samples, std::not_equal_to<>()) == samples.end()) continue;
    const ReceivedStick& stick = received.sticks.back();
    const auto [before, fresh] = seen.emplace(samples, stick);
    if (fresh) continue;
    require(may_be_alike(before->second, stick, received),
            "stick " + std::to_string(stick.sequence) + " holds the samples of stick " +
                std::to_string(before->second.sequence));
    ++alike;
  }
  const std::string sticks = std::to_string(kCompared) + " sticks, ";
  if (alike == 0) return sticks + "no two alike";
  return sticks + std::to_string(alike) + " alike by symmetry, as in a simulation without noise";
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
