// What one rehearsal plays: drawn from its seed.
#pragma once

#include <cstdint>
#include <string>

#include "hw/link/faults.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/card/sim_link.h"

namespace wobblebench::bench {

/// Draws that are a function of seed and count alone.
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
  bool into_volumes = false;  ///< events are put together to volumes; else looked at one by one
  /// Shares of what happens next: the device goes on, the board reads, the program takes.
  double device = 1, board = 1, program = 1;
  double interruptions = 0;  ///< chance that the program stops or cancels, and starts again

  /// One line for people.
  std::string text() const;
};

Scenario draw_scenario(std::uint64_t seed);

}  // namespace wobblebench::bench
