// Envelopes of even tissue on a grid of sticks about one place of the sector.
#pragma once

#include <cstdint>
#include <vector>

#include "hw/probe/probe.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Sticks by motor angle and stick angle; steps between both are even.
struct SpeckleGrid {
  std::vector<double> theta_rad;  ///< of the lines
  int frames = 0;
  int samples = 0;
  double spacing_m = 0;       ///< sample k lies at range (k + 1/2) * spacing_m
  std::vector<float> values;  ///< [frame][line][sample]

  int lines() const { return static_cast<int>(theta_rad.size()); }
  double at(int frame, int line, int sample) const {
    return static_cast<double>(
        values[static_cast<std::size_t>((frame * lines() + line) * samples + sample)]);
  }
  /// First sample at or beyond a range.
  int sample_at(double range_m) const;
};

/// What is asked of a grid.
struct GridPlan {
  double theta_rad = 0;  ///< of its middle
  int lines = 1;
  double theta_step_rad = 0;
  int frames = 1;
  double phi_step_rad = 0;
  double depth_m = 0;
  int samples = 0;
};

/// Soft tissue everywhere, without losses. Rung `scatterers` computes these sticks alone; `field`,
/// which filters noise over a whole scan, a scan of the sector with these steps, of which the lines
/// nearest to the middle are taken. One grid for each of `plans`, whose steps, numbers and depths
/// are the same.
std::vector<SpeckleGrid> speckle_grids(hw::ProbePreset preset,
                                       const sim::SimulationOptions& options,
                                       const std::vector<GridPlan>& plans);

}  // namespace wobblebench::bench
