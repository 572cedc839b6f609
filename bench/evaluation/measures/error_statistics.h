// Statistics of signed depth errors and of angles between normals.
#pragma once

#include <vector>

namespace wobblebench::bench {

/// Signed error: measured minus true depth, positive where the measured surface is too deep.
struct DepthStatistics {
  double bias_m = 0;
  double rms_m = 0;
  double median_m = 0;  ///< of the signed error
  double p95_m = 0;     ///< of its magnitude
  double max_m = 0;     ///< of its magnitude
  int n = 0;            ///< pixels with both surfaces; the other fields are NaN where this is 0
};
DepthStatistics depth_statistics(std::vector<double> errors_m);

/// Angle between measured and true surface normal; NaN where n is 0.
struct NormalStatistics {
  double mean_rad = 0;
  double median_rad = 0;
  double p95_rad = 0;
  int n = 0;
};
NormalStatistics normal_statistics(std::vector<double> angles_rad);

}  // namespace wobblebench::bench
