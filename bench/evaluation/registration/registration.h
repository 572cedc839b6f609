// Splits depth error into what a calibration could remove and the residual: a Ceres fit of pose and
// of the probe's errors that registers the measured surface to the phantom's.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/image.h"
#include "bench/evaluation/registration/probe_fit.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "render/view.h"

namespace wobblebench::bench {

inline constexpr int kRegistrationPoints = 4000;
/// Side of the tiles of the picture whose errors count as one block: more than twice the distance
/// of the default scan's lines (2.5 mm) and frames (3 mm) at 75 mm.
inline constexpr double kErrorBlock_m = 8e-3;

/// The number of the tile that a pixel lies in.
std::int64_t error_block(const render::Camera& camera, int column, int row);

/// Registers pictures of one phantom at one place, which it prepares once.
///
/// @code
/// #include <cstdio>
///
/// #include "bench/evaluation/truth/truth.h"
/// const auto ball = phantoms::still_at(phantoms::make_phantom({.name = "sphere"}), {0, 0, 0.11});
/// const hw::AcquisitionPlan plan({}, {});
/// const render::View view = render::make_view({});
/// const bench::Truth truth = bench::trace_truth(ball, plan, view);
/// const bench::SurfaceRegistration registration(ball, plan, view);
/// const auto fit =
///     registration.fit(truth.depth_m, bench::RegistrationPriors::of_known_pose());
/// std::printf("wobble radius %g m off\n", fit.value[bench::kWobbleRadius]);
/// @endcode
class SurfaceRegistration {
 public:
  SurfaceRegistration(const phantoms::PlacedPhantom& subject,
                      const hw::AcquisitionPlan& plan,
                      const render::View& view,
                      std::uint32_t volume = 0);
  ~SurfaceRegistration();
  SurfaceRegistration(const SurfaceRegistration&) = delete;
  SurfaceRegistration& operator=(const SurfaceRegistration&) = delete;

  Registration fit(const Image<float>& depth_m,
                   const RegistrationPriors& priors = {},
                   int max_points = kRegistrationPoints) const;
  /// Signed distance of what is found to the true surface, pixel by pixel; NaN where none is near.
  Image<float> distances(const Image<float>& depth_m) const;
  /// Fits what differs from pictures with these mean distances(): a detector's error that repeats
  /// from seed to seed is in both, and cancels. It belongs to the surface, so that a point is
  /// compared with what was found where the fit has it. Points within 2.5 mm of a pixel without a
  /// distance are left out.
  Registration fit_difference(const Image<float>& depth_m,
                              const Image<float>& expected_m,
                              const RegistrationPriors& priors,
                              int max_points = kRegistrationPoints) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Fits at most about `max_points` of the measured depths, on a regular grid over the picture, to
/// the phantom's target surfaces (fit_probe()). A moving phantom is taken at the time of each
/// point's stick in this volume of the plan. Not converged where fewer than 20 points are near a
/// surface.
Registration register_surface(const Image<float>& depth_m,
                              const phantoms::PlacedPhantom& subject,
                              const hw::AcquisitionPlan& plan,
                              const render::View& view,
                              const RegistrationPriors& priors = {},
                              int max_points = kRegistrationPoints,
                              std::uint32_t volume = 0);

}  // namespace wobblebench::bench
