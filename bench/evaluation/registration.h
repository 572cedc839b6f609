// Splits depth error into what a calibration could remove and the residual: a Ceres fit of pose,
// range scale and depth bias that registers the measured surface to the phantom's.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "base/image.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "render/view.h"

namespace wobblebench::bench {

/// Standard deviations of zero-mean Gaussian priors on the fitted parameters. A measured point at
/// range rho on its stick, on a picture ray of direction v, is transformed to
///   R(rotation) (stick(scale rho) - bias v - c) + c + translation,   c: centroid of the points.
/// The priors keep unobservable directions (rotation of a sphere, translation in a plane) at zero,
/// with the prior's standard deviation. Observable ones they hardly affect: an error of the form of
/// a scale is fitted as a scale, however large.
struct RegistrationPriors {
  double rotation_rad = 0.05;
  double translation_m = 5e-3;
  double scale = 0.03;
  double bias_m = 2e-3;
};

inline constexpr int kRegistrationParameters = 8;

/// @code
/// #include <cstdio>
///
/// #include "bench/evaluation/registration.h"
/// #include "bench/evaluation/truth.h"
/// const auto ball = phantoms::still_at(phantoms::make_phantom({.name = "sphere"}), {0, 0, 0.11});
/// const hw::AcquisitionPlan plan({}, {});
/// const render::View view = render::make_view({});
/// const bench::Truth truth = bench::trace_truth(ball, plan, view);
/// const auto fit = bench::register_surface(truth.depth_m, ball, plan, view);
/// if (fit.converged) std::printf("bias %g m, %g m RMS\n", fit.value[7], fit.rms_after_m);
/// @endcode
struct Registration {
  bool converged = false;
  int points = 0;   ///< used: within reach of a target surface
  int sampled = 0;  ///< measured depths that were examined
  /// rotation x y z (rad), translation x y z (m), scale - 1, bias (m); NaN, as all that follows,
  /// where there were too few points to fit
  std::array<double, kRegistrationParameters> value;
  /// Row-major posterior covariance, in the units of `value`. Beam and speckle correlate
  /// neighbouring errors, so the true covariance is larger; see docs/architecture.md.
  std::array<double, std::size_t{kRegistrationParameters} * kRegistrationParameters> covariance;
  double rms_before_m;  ///< distance of the points to the surface, before and after the fit
  double rms_after_m;
  /// No value is larger than three standard deviations of its prior; beyond, it is no calibration
  /// error.
  bool within_priors = false;

  Registration();
  double standard_deviation(int parameter) const;
};

inline constexpr int kRegistrationPoints = 4000;

/// Names of `Registration::value` with their units.
const std::array<std::string, kRegistrationParameters>& registration_names();

/// Fits at most about `max_points` of the measured depths, on a regular grid over the picture, to
/// the phantom's target surfaces: Huber loss, Levenberg-Marquardt, automatic derivatives of the
/// fitted pose with the signed distance's gradient. A moving phantom is taken at the time of each
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
