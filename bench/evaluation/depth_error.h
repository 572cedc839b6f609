// Error of a depth image against the truth.
#pragma once

#include "base/image.h"
#include "bench/evaluation/truth.h"
#include "render/camera.h"

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

/// Angle between measured and true surface normal.
struct NormalStatistics {
  double mean_rad = 0;
  double p95_rad = 0;
  int n = 0;
};

/// @code
/// #include <cstdio>
///
/// const render::Camera camera = render::make_camera({});
/// const int side = camera.image_size;
/// const Image<float> measured_m(side, side, 0.101f);
/// const bench::Truth truth{{side, side, 0.1f},
///                          {side, side, glm::vec3(0, 0, -1)},
///                          {side, side, bench::TruthKind::surface}};
/// const bench::DepthError error = bench::measure_depth_error(measured_m, truth, camera);
/// std::printf("bias %g m\n", error.depth.bias_m);  // 0.001
/// @endcode
struct DepthError {
  DepthStatistics depth;
  NormalStatistics normal;
  int missed = 0;         ///< pixels with a true surface and no measured one
  int false_surface = 0;  ///< pixels with a measured surface and no true one
  int outside_field = 0;  ///< pixels whose true surface is outside the probe's field; in neither
  int pixels = 0;
  Image<float> map_m;  ///< signed error; NaN where either surface is absent

  double missed_percent() const { return 100.0 * missed / pixels; }
  double false_percent() const { return 100.0 * false_surface / pixels; }
};

/// Compares measured depths with the truth. Measured normals are central differences of `depth_m`.
DepthError measure_depth_error(const Image<float>& depth_m,
                               const Truth& truth,
                               const render::Camera& camera);

}  // namespace wobblebench::bench
