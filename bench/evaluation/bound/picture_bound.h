// The bound of each pixel of a picture: what a perfect detector's depth image would err by.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <vector>

#include "base/image.h"
#include "bench/evaluation/bound/detection_bound.h"
#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Bounds of many similar conditions, which are brought onto a grid: 5 % of the rise's width, 1 dB
/// of the tissue's echo, a tenth of the number of sticks within the beam.
class BoundTable {
 public:
  /// `like`: pulse, sampling, noise and clutter, which all sticks share.
  explicit BoundTable(const DetectionConditions& like) : like_(like) {}

  using Entry = std::size_t;
  /// Not to be called after compute().
  Entry add(const DetectionConditions& conditions);
  /// On all threads; throws std::invalid_argument as detection_bound_m().
  void compute();
  double bound_m(Entry entry) const { return bounds_[entry]; }
  std::size_t size() const { return entries_.size(); }

 private:
  /// Steps of rise, echo, line and frame density.
  using Key = std::array<int, 4>;
  DetectionConditions conditions_of(const Key& key) const;

  DetectionConditions like_;
  std::map<Key, Entry> entries_;
  std::vector<Key> keys_;
  std::vector<double> bounds_;
};

struct PictureBound {
  /// Root mean square of the bounds of the counted pixels (m, along the picture's rays), of a
  /// detector that judges each stick by itself; NaN where n is 0.
  double rms_m = 0;
  /// The same where pixels between sticks are linear between four of them with independent errors:
  /// 2/3 of it. What the surface's curvature between sticks adds is spacing_error()'s.
  double between_sticks_m = 0;
  int n = 0;           ///< counted pixels with a true surface that has a bound
  int grazing = 0;     ///< counted pixels left out: incidence above kMostIncidence_rad
  Image<float> map_m;  ///< bound; kNoSurface where there is none
};

/// Selects pixels, such as those away from silhouettes.
using CountedPixel = std::function<bool(int column, int row)>;

/// Computes the bounds from the truth's normals, the beam at each point and the scan's spacing.
/// `tissue_mean_db`: mean echo of the material behind the surface (`Material::backscatter_db`)
/// minus the losses along the path. The echo of the interface itself is left out. Bounds are looked
/// up in steps of 5 % of the rise's width and 1 dB of the echo. Throws std::invalid_argument as
/// detection_bound_m().
///
/// @code
/// const bench::PictureBound bound = bench::picture_bound(
///     truth, view.camera, plan, simulation, -42, [](int, int) { return true; });
/// const double ratio = error.depth.rms_m / bound.between_sticks_m;
/// @endcode
PictureBound picture_bound(const Truth& truth,
                           const render::Camera& camera,
                           const hw::AcquisitionPlan& plan,
                           const sim::SimulationOptions& simulation,
                           double tissue_mean_db,
                           const CountedPixel& counted);

/// Factor by which bilinear interpolation between four sticks reduces the RMS of their independent
/// errors, over a cell: the root of the integral of (1 - t)^2 + t^2, which is 2/3, for each of the
/// two directions.
inline constexpr double kBetweenSticks = 2.0 / 3;

}  // namespace wobblebench::bench
