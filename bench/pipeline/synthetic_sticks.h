// Sticks of noise, for tests and studies of link and board.
#pragma once

#include <cstdint>

#include "sim/card/sim_link.h"

namespace wobblebench::bench {

/// Sample k of a stick is a function of seed, sequence and k alone, uniform in [0, 1).
float synthetic_sample(std::uint64_t seed, std::uint64_t sequence, std::uint32_t sample);

sim::StickSource synthetic_sticks(const hw::AcquisitionPlan& plan, std::uint64_t seed);

}  // namespace wobblebench::bench
