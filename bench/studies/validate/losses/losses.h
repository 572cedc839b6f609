// Points in attenuating tissue against tests/yardstick/attenuation.csv, and uniform tissue behind
// a thin half plane that passes a tenth of the amplitude each way, against
// tests/yardstick/shadow.csv.
#pragma once

#include <vector>

#include "bench/studies/validate/common/study_report.h"

namespace wobblebench::bench {

/// The shadow's edge at one range, standard probe, rung `field`.
struct ShadowEdge {
  bool across_lines = false;
  double range_m = 0;
  double rise_m = 0;  ///< 10 to 90 % of the amplitude between both ends
  double expected_rise_m = 0;
  std::vector<double> crossing_m;
  std::vector<double> level_db;
  std::vector<double> expected_db;
};

/// For each edge and range of the table. Scans the plane twice, by lines and by frames.
std::vector<ShadowEdge> measure_shadow_edges();

/// Distance between the first points, counted from the dark end, the last crossing, at which the
/// amplitude has risen by 10 and by 90 % of the step between the two ends.
double rise_m(const std::vector<double>& crossing_m, const std::vector<double>& level_db);

StudyReport losses_report();

}  // namespace wobblebench::bench
