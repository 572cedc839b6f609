// What a volume costs on each rung of the simulator. Timings are measured, never asserted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// What is scanned in a trade, and how.
struct TradeScene {
  phantoms::PlacedPhantom subject;  ///< still
  hw::AcquisitionPlan plan;
  sim::SimulationOptions options;  ///< but for the rung
};

/// A slow path, so that nothing of a volume is known from the one before.
phantoms::Motion slow_path();
/// The same with a turning joint, where the phantom has one: tissue that bends.
phantoms::Motion bending(const phantoms::Phantom& phantom);

/// Moving volumes are timed this many in a row, and averaged: a scan goes on.
inline constexpr int kVolumesInARow = 3;

/// Wall times, all threads that the options allow.
struct RungTime {
  sim::Rung rung = sim::Rung::field;
  Spread map_ms;      ///< once for a phantom
  Spread once_ms;     ///< once for a probe and seed, the phantom still: tables, speckle, all echoes
  Spread still_ms;    ///< each further volume of a still phantom: its noise and receive chain
  Spread first_ms;    ///< once_ms and one volume: a still volume of a new seed
  Spread moving_ms;   ///< a volume of a phantom on a path
  Spread bending_ms;  ///< a volume of a phantom that bends
};

/// All rungs in turn in each repeat, after one that is not counted, so that a drift of the
/// machine's speed touches all alike.
std::vector<RungTime> measure_times(const TradeScene& scene,
                                    const std::vector<sim::Rung>& rungs,
                                    int repeats);

/// A still volume of a new seed, and one of a phantom on a path; as above, for one rung alone.
struct VolumeTime {
  Spread first_ms;
  Spread moving_ms;
};
VolumeTime measure_volume(const TradeScene& scene, sim::Rung rung, int repeats);

}  // namespace wobblebench::bench
