// Error of a depth image against the truth, pixel by pixel, and its statistics.
#pragma once

#include <vector>

#include "base/image.h"
#include "base/units.h"
#include "bench/evaluation/truth/truth.h"
#include "bench/results/measure.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// An error of another surface, which no quantile below it shows.
inline constexpr double kOutlier_m = 10e-3;

/// Signed error: measured minus true depth, positive where the measured surface is too deep.
struct DepthStatistics {
  double bias_m = 0;
  double rms_m = 0;
  double median_m = 0;       ///< median of the signed error
  double p95_m = 0;          ///< 95 % quantile of its magnitude
  double max_m = 0;          ///< largest magnitude
  double outlier_share = 0;  ///< of the n pixels: magnitude above kOutlier_m
  int n = 0;  ///< pixels with both surfaces; the other fields are NaN where this is 0
};
DepthStatistics depth_statistics(std::vector<double> errors_m);
void describe(const DepthStatistics& depth, Measurements& to);

/// Angle between measured and true surface normal; NaN where n is 0.
struct NormalStatistics {
  double mean_rad = 0;
  double median_rad = 0;
  double p95_rad = 0;
  int n = 0;
};
NormalStatistics normal_statistics(std::vector<double> angles_rad);

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
  int surface = 0;        ///< pixels with a true surface that the probe can see
  int missed = 0;         ///< those of them with no measured one
  int false_surface = 0;  ///< pixels with a measured surface and no true one
  // Pixels whose true surface the probe cannot see, by the reason (TruthKind); in none of the
  // above.
  int outside_field = 0;
  int grazing = 0;
  int shadowed = 0;
  int pixels = 0;
  double surface_m2 = 0;      ///< area of the true surface in the pixels `surface` (truth/truth.h)
  double missed_m2 = 0;       ///< in the pixels `missed`
  double found_m2 = 0;        ///< area of the measured surface, all of it
  double false_m2 = 0;        ///< in the pixels `false_surface`
  Image<float> map_m;         ///< signed error; NaN where either surface is absent
  Image<float> normal_rad;    ///< angle between the normals; NaN where there is none
  Image<float> unseen_map_m;  ///< signed error where the probe cannot see the surface

  /// A true surface is in view; without one there is nothing to find or to miss.
  bool surface_in_view() const { return surface > 0; }
  /// Percentages of all pixels of the picture, background included.
  double missed_percent() const { return 100.0 * missed / pixels; }
  double false_percent() const { return 100.0 * false_surface / pixels; }
  /// Percentage of the area of the true surface in view; NaN where there is none.
  double missed_surface_percent() const { return 100.0 * missed_m2 / surface_m2; }
  /// Percentage of the area of the measured surface; NaN where there is none.
  double false_surface_percent() const { return 100.0 * false_m2 / found_m2; }
};

/// Percentages are not formed where no surface is in view.
void describe(const DepthError& found, Measurements& to);

/// Depths of neighbouring pixels that differ by more belong to different surfaces: their slope
/// would be 83 degrees at 0.4 mm a pixel.
inline constexpr double kSurfaceJump_m = 3e-3;

/// Compares measured depths with the truth. MeasuredValue normals are central differences of
/// `depth_m`; the area of a measured pixel beside a gap or a jump of the measured surface is that
/// of a surface that faces the viewer.
DepthError measure_depth_error(const Image<float>& depth_m,
                               const Truth& truth,
                               const render::Camera& camera);

}  // namespace wobblebench::bench
