// Splits depth error into what a calibration could remove and what is left: a Ceres fit of pose,
// range scale and depth bias that lays the detected surface onto the phantom's.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <string>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// What the fit may move. A detected point at range rho on its stick, seen along the ray v, goes to
///   R(rotation) (stick(scale rho) - bias v - c) + c + translation,   c: centroid of the points.
/// Priors of these widths keep a direction that the surface cannot show (a sphere's rotation, a
/// plane's sliding) at zero; its standard deviation is then the prior's own. They do not hold back
/// a direction that it does show: an error that looks like a scale is fitted as a scale, however
/// large.
struct RegistrationPriors {
  double rotation_rad = 0.05;
  double translation_m = 5e-3;
  double scale = 0.03;
  double bias_m = 2e-3;
};

inline constexpr int kRegistrationParameters = 8;

struct Registration {
  bool converged = false;
  int points = 0;   ///< used: within reach of a target surface
  int sampled = 0;  ///< found depths that were looked at
  /// rotation x y z (rad), translation x y z (m), scale - 1, bias (m); NaN, as all that follows,
  /// where there were too few points to fit
  std::array<double, kRegistrationParameters> value;
  /// Row-major posterior covariance, in the units of `value`. Neighbouring errors are correlated by
  /// beam and speckle, so the true spread is wider; see docs/architecture.md.
  std::array<double, std::size_t{kRegistrationParameters} * kRegistrationParameters> covariance;
  double rms_before_m;  ///< distance of the points to the surface
  double rms_after_m;
  /// No value is farther from zero than three priors: beyond, the fit explains more than a
  /// calibration error could be.
  bool within_priors = false;

  Registration();
  double standard_deviation(int parameter) const;
};

/// Names of `Registration::value` with their units.
const std::array<std::string, kRegistrationParameters>& registration_names();

/// Fits at most about `max_points` of the found depths, evenly spread over the picture, to the
/// phantom's target surfaces: Huber loss, Levenberg-Marquardt, automatic derivatives of the fitted
/// pose with the signed distance's own gradient. Where the phantom moves, each point is compared
/// with it as it stood when the point's stick was fired. Fewer than 20 points near a surface: not
/// converged.
Registration register_surface(const Image<float>& depth_m,
                              const phantoms::PlacedPhantom& subject,
                              const hw::AcquisitionPlan& plan,
                              const render::RenderOptions& options,
                              const RegistrationPriors& priors = {},
                              int max_points = 4000);

}  // namespace wobblebench::bench
