// CPU time of each stage of a rung.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/studies/rungs/rung_comparison.h"

namespace wobblebench::bench {

/// CPU time of one volume of a moving phantom on one thread.
struct StageTimes {
  sim::Rung rung = sim::Rung::field;
  std::vector<std::pair<std::string, double>> stages;  ///< in the order of the signal path
  double once_ms = 0;  ///< homogeneous speckle or the beam's table: once per probe and seed
  std::uint64_t scatterers = 0;  ///< echoes of single scatterers, over all sticks

  double total_ms() const;
};

/// Times the stages that the simulator calls (sim/rungs/stick_propagation.h, sim/rungs/iq_model.h)
/// one by one; "rest" is what remains of its total time.
StageTimes measure_stages(const RungScene& scene, sim::Rung rung);

}  // namespace wobblebench::bench
