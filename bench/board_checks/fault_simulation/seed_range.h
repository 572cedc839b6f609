// The fault simulation over a range of seeds.
#pragma once

#include <cstdint>
#include <vector>

#include "base/part_done.h"
#include "bench/board_checks/fault_simulation/fault_simulation.h"
#include "hw/wire/account.h"

namespace wobblebench::bench {

/// Sums over all seeds.
struct SeedRangeResult {
  std::uint64_t first_seed = 1;
  int seeds = 0;
  std::vector<FaultSimulationResult> failed;
  std::uint64_t hash = 0;  ///< of all hashes, in the order of the seeds
  double device_time_s = 0;
  double acquired_s = 0;
  double wall_s = 0;
  std::uint64_t steps = 0;
  std::uint64_t sticks = 0;
  hw::BoardAccount account;
  std::uint64_t bytes_recorded = 0;
  std::uint64_t sticks_salvaged = 0;
};

/// `seeds` simulations, from `first_seed` on, on all threads, each of which calls `done`.
SeedRangeResult simulate_seeds(std::uint64_t first_seed, int seeds, const PartDone& done = {});

}  // namespace wobblebench::bench
