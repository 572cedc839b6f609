// The scenario of one fault simulation, drawn from its seed, and its clock.
#pragma once

#include <cstdint>
#include <string>

#include "hw/link/fault_link.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/probe/clock.h"
#include "sim/card/sim_link.h"

namespace wobblebench::bench {

/// Random numbers, a function of seed and count alone.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t next();
  /// Uniform in [0, 1).
  double uniform();
  /// Uniform from `least` to `most`, both included.
  int between(int least, int most);
  bool chance(double probability) { return uniform() < probability; }

 private:
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

struct Scenario {
  std::uint64_t seed = 1;
  hw::AcquisitionPlan plan;
  sim::SimLinkOptions link;
  hw::FaultPlan faults;
  int ring_slots = 1;
  bool assemble_volumes = false;  ///< the program takes volumes; else single events
  /// Weights of the next action: device time advances, the board reads, the program takes.
  double device = 1, board = 1, program = 1;
  double interruptions = 0;  ///< probability that the program stops or cancels, and starts again

  /// One line for the trace.
  std::string text() const;
};

Scenario draw_scenario(std::uint64_t seed);

/// The clock of a fault simulation.
class VirtualTime : public hw::HostTimeSource {
 public:
  hw::HostTime now() const override { return now_; }
  void advance(hw::HostClock::duration duration) { now_ += duration; }

 private:
  hw::HostTime now_{};
};

}  // namespace wobblebench::bench
