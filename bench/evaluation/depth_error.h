// How wrong a depth image is.
#pragma once

#include "bench/evaluation/truth.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// Signed error is found minus true depth: positive lies too deep. Lengths in metres.
struct DepthStatistics {
  double bias_m = 0;
  double rms_m = 0;
  double median_m = 0;  ///< of the signed error
  double p95_m = 0;     ///< of its magnitude
  double max_m = 0;     ///< of its magnitude
  int n = 0;            ///< pixels where both surfaces are; all figures are NaN where this is 0
};

struct NormalStatistics {
  double mean_rad = 0;
  double p95_rad = 0;
  int n = 0;
};

struct DepthError {
  DepthStatistics depth;
  NormalStatistics normal;
  /// Pixels, apart: a true surface that was not found, a found surface where there is none, and
  /// true surfaces beyond the probe's field, which count as neither.
  int missed = 0;
  int false_surface = 0;
  int outside_field = 0;
  int pixels = 0;
  Image<float> map_m;  ///< signed error; NaN where either surface is absent

  double missed_percent() const { return 100.0 * missed / pixels; }
  double false_percent() const { return 100.0 * false_surface / pixels; }
};

/// Compares found depths with the truth. Normals come from central differences of `depth_m`.
DepthError measure_depth_error(const Image<float>& depth_m,
                               const Truth& truth,
                               const render::RenderOptions& options);

}  // namespace wobblebench::bench
