// Deterministic simulation of faults: the path from probe to volume in one thread and virtual time,
// with faults and a schedule drawn from a seed, so that a failure can be repeated.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "hw/wire/account.h"

namespace wobblebench::bench {

struct FaultSimulationResult {
  std::uint64_t seed = 0;
  /// Of schedule, events, sticks, accounts and recorded bytes, in order.
  std::uint64_t hash = 0;
  double device_time_s = 0;  ///< simulated
  double acquired_s = 0;     ///< duration of the emitted sticks
  std::uint64_t steps = 0;
  std::uint64_t sticks_emitted = 0;  ///< by the probe
  hw::BoardAccount account;
  std::uint64_t bytes_recorded = 0;   ///< by the recorder, until it was killed
  std::uint64_t sticks_salvaged = 0;  ///< of what a kill left of them
  std::string failure;                ///< the rule violated; empty: none
};

/// Simulates one seed. `trace`, if given, receives a line for each event. Rules checked at every
/// step: emitted = delivered + lost; each stick is bit for bit the one that the probe sent, and
/// comes once, in order; sticks and gaps cover every sequence number once. At the end: every stick
/// that is missing was hit by a fault or dropped by a full ring. Then the same probe, card and
/// faults are recorded (recording_simulation.h).
FaultSimulationResult simulate_faults(std::uint64_t seed,
                                      const std::function<void(const std::string&)>& trace = {});

/// The fault simulation over a range of seeds: sums over all of them.
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
