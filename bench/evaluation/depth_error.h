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
  int surface = 0;        ///< pixels with a true surface within the probe's field
  int missed = 0;         ///< those of them with no measured one
  int false_surface = 0;  ///< pixels with a measured surface and no true one
  int outside_field = 0;  ///< pixels whose true surface is outside the probe's field; in neither
  int pixels = 0;
  double surface_m2 = 0;  ///< area of the true surface in the pixels `surface` (pixel_area_m2())
  double missed_m2 = 0;   ///< in the pixels `missed`
  Image<float> map_m;     ///< signed error; NaN where either surface is absent

  /// A true surface is in view; without one there is nothing to find or to miss.
  bool surface_in_view() const { return surface > 0; }
  /// Of all pixels of the picture, background included.
  double missed_percent() const { return 100.0 * missed / pixels; }
  double false_percent() const { return 100.0 * false_surface / pixels; }
  /// Of the area of the true surface in view; NaN where there is none.
  double missed_surface_percent() const { return 100.0 * missed_m2 / surface_m2; }
};

/// Compares measured depths with the truth. Measured normals are central differences of `depth_m`.
DepthError measure_depth_error(const Image<float>& depth_m,
                               const Truth& truth,
                               const render::Camera& camera);

}  // namespace wobblebench::bench
