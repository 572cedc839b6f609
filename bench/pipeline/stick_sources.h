// Where sticks come from without a board: a scene's simulated probe, and noise.
#pragma once

#include <cstdint>
#include <memory>

#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/iq_file.h"
#include "bench/scene/scene.h"
#include "sim/card/sim_link.h"

namespace wobblebench::bench {

struct SimulatedScan {
  sim::ProbeSimulator simulator;
  Scene scene;  ///< as resolved
};

/// Makes phantom and simulator. Throws UserError, InvalidOption.
SimulatedScan simulated_scan(const Scene& given, PhantomCache cache = {});

/// Each call of the result gives a source that begins with volume 0. `iq`: where the IQ samples of
/// its volumes go; null: nowhere.
MakeSticks simulated_sticks(SimulatedScan scan, std::shared_ptr<IqFile> iq = {});

/// Noise, for tests and studies of link and board: sample k of a stick is a function of seed,
/// sequence and k alone, uniform in [0, 1).
float synthetic_sample(std::uint64_t seed, std::uint64_t sequence, std::uint32_t sample);

sim::StickSource synthetic_sticks(const hw::AcquisitionPlan& plan, std::uint64_t seed);

}  // namespace wobblebench::bench
