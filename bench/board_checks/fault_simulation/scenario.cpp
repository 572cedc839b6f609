#include "bench/board_checks/fault_simulation/scenario.h"

#include <algorithm>
#include <sstream>

#include "base/hash.h"

namespace wobblebench::bench {

namespace {

constexpr double kFaultRates[] = {0.002, 0.02, 0.2};

hw::AcquisitionPlan draw_plan(Draws& draws) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = draws.between(1, 6);
  acquisition.sticks_per_frame = draws.between(1, 24);
  acquisition.samples_per_stick = draws.between(2, 24);
  acquisition.volumes = draws.between(1, 6);
  acquisition.motor = static_cast<hw::MotorMode>(draws.between(0, 3));
  return {{}, acquisition};
}

sim::SimLinkOptions draw_link(Draws& draws) {
  sim::SimLinkOptions link;
  link.pace = draws.chance(0.7) ? hw::Pace::realtime : hw::Pace::asap;
  link.volumes_ahead = 0;
  link.card.buffer_bytes = 64 << draws.between(0, 7);
  link.card.buffers = draws.between(2, 64);
  link.card.buffers_per_interrupt = draws.between(1, std::min(8, link.card.buffers));
  link.card.payload_rate_mb_s = draws.chance(0.5) ? 900 : 5;
  link.card.interrupt_latency_s = draws.chance(0.5) ? 0 : 1e-3 * draws.uniform();
  return link;
}

hw::FaultPlan draw_faults(Draws& draws) {
  hw::FaultPlan plan;
  plan.seed = draws.next();
  plan.delay = std::chrono::microseconds(draws.between(0, 3000));
  plan.stall = std::chrono::microseconds(draws.between(0, 30000));
  if (draws.chance(0.3)) return plan;
  for (int kind = 0; kind < hw::kFaultKinds; ++kind) {
    if (static_cast<hw::FaultKind>(kind) == hw::FaultKind::unplug) {
      if (draws.chance(0.1)) {
        plan.faults.push_back({hw::FaultKind::unplug, 0, draws.next() % 400});
      }
    } else if (draws.chance(0.3)) {
      plan.faults.push_back(
          {static_cast<hw::FaultKind>(kind), kFaultRates[draws.between(0, 2)], {}});
    }
  }
  return plan;
}

}  // namespace

std::uint64_t Draws::next() {
  return mix64(seed_ * kGoldenGamma + ++count_ * 0xD1B54A32D192ED03);
}

double Draws::uniform() {
  return unit_interval(next());
}

int Draws::between(int least, int most) {
  return least + static_cast<int>(next() % static_cast<std::uint64_t>(most - least + 1));
}

Scenario draw_scenario(std::uint64_t seed) {
  Draws draws(seed);
  const hw::AcquisitionPlan plan = draw_plan(draws);
  Scenario scenario{
      .seed = seed, .plan = plan, .link = draw_link(draws), .faults = draw_faults(draws)};
  scenario.ring_slots = 1 << draws.between(0, 8);
  scenario.assemble_volumes = draws.chance(0.4);
  scenario.device = 0.2 + draws.uniform();
  scenario.board = 0.2 + draws.uniform();
  scenario.program = 0.2 + draws.uniform();
  scenario.interruptions = draws.chance(0.3) ? 0.02 : 0;
  return scenario;
}

std::string Scenario::text() const {
  const hw::AcquisitionOptions& a = plan.acquisition();
  std::ostringstream line;
  line << a.volumes << " volumes of " << a.frames_per_volume << " x " << a.sticks_per_frame
       << " sticks of " << a.samples_per_stick << ", motor " << static_cast<int>(a.motor) << ", "
       << (link.pace == hw::Pace::realtime ? "realtime" : "asap") << ", card " << link.card.buffers
       << " x " << link.card.buffer_bytes << " bytes, " << link.card.buffers_per_interrupt
       << " an interrupt, ring " << ring_slots << (assemble_volumes ? ", into volumes" : "");
  for (const hw::Fault& fault : faults.faults) {
    line << ", " << hw::to_string(fault.kind);
    if (fault.at) {
      line << "@" << *fault.at;
    } else {
      line << ":" << fault.rate;
    }
  }
  return line.str();
}

}  // namespace wobblebench::bench
