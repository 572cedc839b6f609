// The whole path from the probe to the volume, played on virtual time in one thread by a seeded
// schedule, with faults: the same seed plays the same, so that what fails can be played again.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "hw/wire/account.h"

namespace wobblebench::bench {

struct FaultSimulationResult {
  std::uint64_t seed = 0;
  /// Of all that happened, in order: the schedule, events, sticks, accounts.
  std::uint64_t hash = 0;
  double device_time_s = 0;  ///< that passed
  double acquired_s = 0;     ///< that the sticks emitted take, one after the other
  std::uint64_t steps = 0;
  std::uint64_t sticks_emitted = 0;  ///< by the probe
  hw::BoardAccount account;
  std::string failure;  ///< the rule that did not hold; empty: all did
};

/// Plays one seed. `trace`, if given, is told each event in a line. Rules that are looked at, at
/// every step: emitted = delivered + lost; each stick is bit for bit the one that the probe sent,
/// and comes once, in order; sticks and gaps name every number once; and at the end: nothing that
/// no fault struck and no ring dropped is missing.
FaultSimulationResult simulate_faults(std::uint64_t seed,
                                      const std::function<void(const std::string&)>& trace = {});

}  // namespace wobblebench::bench
