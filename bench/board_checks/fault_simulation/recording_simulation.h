// Fault simulation of a recording: recorded, killed, cut anywhere, inspected, salvaged.
#pragma once

#include <cstdint>

#include "bench/board_checks/fault_simulation/oracle.h"
#include "bench/board_checks/fault_simulation/scenario.h"

namespace wobblebench::bench {

struct RecordingSimulationResult {
  std::uint64_t hash = 0;  ///< of the recorded bytes and what is made of them
  std::uint64_t bytes_recorded = 0;
  std::uint64_t sticks_salvaged = 0;
  std::string failure;  ///< the rule violated; empty: none
};

/// Records the scenario's link through hw::Recorder into memory, with reads of any length. A kill
/// at any read leaves what the recorder gave away until then, cut at any byte. RecordingOracle
/// checks the recorder, the inspection of the rest, its salvage, and the salvage of that.
RecordingSimulationResult simulate_recording(const Scenario& scenario, const Oracle::Trace& trace);

}  // namespace wobblebench::bench
