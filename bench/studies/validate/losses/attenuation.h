// Attenuation: its slope in homogeneous tissue, the shadow behind bone, the enhancement behind a
// cyst.
#pragma once

#include <cstdint>
#include <vector>

#include "base/units.h"
#include "bench/studies/validate/common/statistics.h"
#include "bench/studies/validate/common/study_report.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct AttenuationInputs {
  std::vector<std::uint64_t> seeds = seeds_from(1, 2);
  int sticks = 24;
  int frames = 16;
  /// Scan of homogeneous tissue: no aperture reaches the array's end, where echoes fall with range.
  double sector_rad = 30 * kDegree;
  double fan_rad = 61 * kDegree;
};

/// Mean echo of homogeneous tissue over depth.
struct SlopeResult {
  std::vector<double> range_m;
  std::vector<double> level_db;     ///< mean intensity, 0 dB: a perfect mirror
  std::vector<double> expected_db;  ///< the band's sum, from the first level on
  double slope_db_per_cm = 0;       ///< of a line through the levels
  double expected_db_per_cm = 0;    ///< of a line through the band's sum
  long n = 0;
};
SlopeResult measure_slope(sim::Rung rung, bool speckle, const AttenuationInputs& inputs);

/// Mean echo of sticks near the axis with a body in tissue, over that without it.
struct ShadowResult {
  std::vector<double> range_m;
  std::vector<double> change_db;    ///< of the mean intensity, in bins of range
  std::vector<double> expected_db;  ///< of the band at the bin's middle; NaN within the body
  double behind_db = 0;             ///< mean intensity behind the body over that without it
  double expected_behind_db = 0;
  long n = 0;
};
/// Expected: two-way transmission (1 - R^2) of both faces, and what TissueBand leaves of the path
/// with the plate less what it leaves of the path without it.
ShadowResult measure_bone_shadow(sim::Rung rung, const AttenuationInputs& inputs);
/// The same for a sphere of fluid, with each stick's chord through it.
ShadowResult measure_cyst_enhancement(sim::Rung rung, const AttenuationInputs& inputs);

StudyReport attenuation_report();

}  // namespace wobblebench::bench
