// What report.json says of the simulator.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "sim/fidelity.h"

namespace wobblebench::bench {

/// Sets "effects", those that ran, and "simulation": the rung, why it was taken, and what it leaves
/// out. `fidelity`: none where nothing was simulated.
void report_fidelity(nlohmann::ordered_json& report, const std::optional<sim::Fidelity>& fidelity);

}  // namespace wobblebench::bench
