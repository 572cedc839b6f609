// Simulation time of a volume on each rung. Measured, never asserted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/part_done.h"
#include "base/statistics.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// A scan that all rungs are compared on.
struct RungScene {
  phantoms::PlacedPhantom subject;  ///< still
  hw::AcquisitionPlan plan;
  sim::SimulationOptions options;  ///< the rung is overridden
};

/// A slow translation, so that no echoes can be reused in the next volume.
phantoms::Motion slow_path();
/// The same with a turning joint, where the phantom has one: its tissue deforms.
phantoms::Motion bending(const phantoms::Phantom& phantom);

/// Moving volumes are timed in series of this many and averaged, as in a continuous scan.
inline constexpr int kVolumesInARow = 3;

/// Wall times with all threads that the options allow.
struct RungTime {
  sim::Rung rung = sim::Rung::field;
  Spread map_ms;      ///< once per phantom
  Spread once_ms;     ///< once per probe and seed, still phantom: tables, speckle, all echoes
  Spread still_ms;    ///< each further volume of a still phantom: its noise and receive chain
  Spread first_ms;    ///< once_ms and one volume: a still volume of a new seed
  Spread moving_ms;   ///< a volume with slow_path()
  Spread bending_ms;  ///< a volume with bending()
};

/// All rungs in turn in each repeat, after one warm-up repeat, so that a drift of the machine's
/// speed affects all equally.
std::vector<RungTime> measure_times(const RungScene& scene,
                                    const std::vector<sim::Rung>& rungs,
                                    int repeats,
                                    const PartDone& done = {});

/// A still volume of a new seed and one with slow_path(), on one rung.
struct VolumeTime {
  Spread first_ms;
  Spread moving_ms;
};
VolumeTime measure_volume(const RungScene& scene, sim::Rung rung, int repeats);

/// Sizes are varied one at a time from one base scan.
struct GrowthInputs {
  hw::AcquisitionOptions acquisition = {.sticks_per_frame = 32, .frames_per_volume = 12};
  std::vector<int> sticks = {16, 32, 64, 128};
  std::vector<int> frames = {6, 12, 24, 48};
  std::vector<int> samples = {256, 512, 1024, 2048};
  std::vector<double> scatterers = {5, 10, 20, 40};
  /// Range of the tissue's front, mm; beyond the depth: fluid alone.
  std::vector<double> front_mm = {400, 130, 100, 70, 35, -50};
  double base_front_mm = 70;
  int repeats = 9;  ///< of each point, after one warm-up
};

struct GrowthPoint {
  std::string what;  ///< "sticks", "frames", "samples", "scatterers", "tissue"
  double size = 0;   ///< their number; of tissue: its fraction of the samples
  sim::Rung rung = sim::Rung::field;
  VolumeTime time;
};

std::vector<GrowthPoint> measure_growth(const std::vector<sim::Rung>& rungs,
                                        const sim::SimulationOptions& options,
                                        const GrowthInputs& inputs,
                                        const PartDone& done = {});

/// Exponent of median time over size among the points of one kind and rung: least squares of their
/// logarithms.
double growth_exponent(const std::vector<GrowthPoint>& points,
                       const std::string& what,
                       sim::Rung rung,
                       Spread VolumeTime::*time);

}  // namespace wobblebench::bench
