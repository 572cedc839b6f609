// Where a rung's time goes, stage by stage along a stick's way.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "bench/studies/trade/rung_time.h"

namespace wobblebench::bench {

/// CPU milliseconds of one volume of a phantom on a path, on one thread.
struct StageTimes {
  sim::Rung rung = sim::Rung::field;
  std::vector<std::pair<std::string, double>> stages;  ///< in the order of the signal's way
  double once_ms = 0;            ///< even speckle, or the beam's table: once for a probe and seed
  std::uint64_t scatterers = 0;  ///< that contributed to a stick, over all sticks

  double total_ms() const;
};

/// Calls the stages that the simulator itself calls (sim/echo/stick_propagation.h,
/// sim/echo/iq_model.h), one by one, with a clock between them; what it does besides is the rest.
StageTimes measure_stages(const TradeScene& scene, sim::Rung rung);

}  // namespace wobblebench::bench
