// Growth of the simulation time of a volume with its sizes.
#pragma once

#include <string>
#include <vector>

#include "bench/studies/rungs/rung_time.h"

namespace wobblebench::bench {

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
