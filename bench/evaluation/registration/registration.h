// Splits depth error into what a calibration could remove and the residual: a Ceres fit of what a
// scanner may assume wrongly about its probe, and of the phantom's pose, that registers the
// measured surface to the phantom's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "phantoms/truth.h"
#include "render/view.h"

namespace wobblebench::bench {

inline constexpr int kRegistrationParameters = 10;

/// Indices into Registration::value. Each value is true minus assumed; the pose is what
/// moves the measured points onto the phantom.
enum RegistrationParameter {
  kRotation = 0,     ///< x, y, z, rad: about the centroid of the points
  kTranslation = 3,  ///< x, y, z, m
  kScale = 6,        ///< true over assumed speed of sound - 1: of the range along a stick
  kBias = 7,         ///< m: detected too deep along the picture's ray
  kMotorAngle = 8,   ///< rad: offset of every motor angle
  kWobbleRadius = 9  ///< m
};

/// Names of the parameters with their units.
const std::array<std::string, kRegistrationParameters>& registration_names();

/// Standard deviations of zero-mean Gaussian priors on the fitted parameters; 0: held at zero. The
/// defaults are of a probe that turns as it says, at an unknown pose. A
/// point measured at range rho, stick angle theta and motor angle phi, on a picture ray of
/// direction v, is at
///   R(rotation) (stick(scale rho, theta, phi + motor angle; wobble radius) - bias v - c) + c +
///   translation,   c: centroid of the points.
/// The priors keep unobservable directions (rotation of a sphere, translation in a plane) at zero,
/// with the prior's standard deviation. Observable ones they hardly affect: an error of the form of
/// a scale is fitted as a scale, however large.
struct RegistrationPriors {
  double rotation_rad = 0.05;
  double translation_m = 5e-3;
  double scale = 0.03;
  double bias_m = 2e-3;
  double motor_angle_rad = 0;
  double wobble_radius_m = 0;

  /// The pose is held: the phantom stands where the bench put it. An offset of the motor is a
  /// rotation about the wobble axis, so that one of the two must be known.
  static RegistrationPriors of_known_pose() {
    return {
        .rotation_rad = 0, .translation_m = 0, .motor_angle_rad = 0.05, .wobble_radius_m = 3e-3};
  }
  /// Nothing is held.
  static RegistrationPriors of_nothing_known() {
    return {.motor_angle_rad = 0.05, .wobble_radius_m = 3e-3};
  }
  std::array<double, kRegistrationParameters> sigma() const {
    return {rotation_rad,
            rotation_rad,
            rotation_rad,
            translation_m,
            translation_m,
            translation_m,
            scale,
            bias_m,
            motor_angle_rad,
            wobble_radius_m};
  }
};

/// Parameters that the data cannot tell apart: of the combination, in prior standard deviations,
/// they are the main part.
struct UnseenParameters {
  std::vector<int> parameters;
  double data_over_prior;  ///< its standard deviation from the data alone over the prior's; > 1
};

/// @code
/// #include <cstdio>
///
/// #include "bench/evaluation/truth/truth.h"
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
  int blocks = 0;   ///< blocks of the bootstrap
  /// Indexed by RegistrationParameter; NaN, as all that follows, where there were too few points to
  /// fit.
  std::array<double, kRegistrationParameters> value;
  std::array<double, kRegistrationParameters> low;  ///< 95 % interval of the block bootstrap
  std::array<double, kRegistrationParameters> high;
  /// Row-major, of the block bootstrap, in the units of `value`; zero where a parameter is held.
  std::array<double, std::size_t{kRegistrationParameters} * kRegistrationParameters> covariance;
  double rms_before_m;  ///< distance of the points to the surface, before and after the fit
  double rms_after_m;
  /// Mean variance of a parameter over what it would be if points were independent.
  double variance_inflation;
  /// No value is larger than three standard deviations of its prior; beyond, it is no calibration
  /// error.
  bool within_priors = false;
  std::vector<UnseenParameters> unseen;
  std::vector<std::pair<int, int>> correlated;  ///< |correlation| > 0.95

  Registration();
  double standard_deviation(int parameter) const;
  double correlation(int one, int other) const;
};

/// A point of the measured surface, as the assumed probe gives it.
struct MeasuredPoint {
  hw::PolarPoint polar;
  glm::dvec3 view_direction{0, 0, 1};  ///< direction of the pixel's ray
  hw::StickIndex fired;                ///< the stick whose time the point has
  std::int64_t block = 0;              ///< points of one block have correlated errors
};

/// Signed distance to the true surface at a position, at the time of a stick; none beyond reach.
using DistanceTo = std::function<std::optional<phantoms::SurfaceFinder::Distance>(
    const glm::dvec3& position_m, const hw::StickIndex& fired)>;

inline constexpr int kLeastPoints = 20;
/// Measured points farther than this from every target surface belong to none of them.
inline constexpr double kFarPoint_m = 6e-3;

/// Huber loss, Levenberg-Marquardt, automatic derivatives of the fitted position with the signed
/// distance's gradient; intervals by bootstrap of blocks. Not converged for fewer than kLeastPoints
/// points.
Registration fit_probe(const std::vector<MeasuredPoint>& points,
                       const DistanceTo& distance_to,
                       const hw::ProbeGeometry& assumed,
                       const RegistrationPriors& priors = {});

inline constexpr int kRegistrationPoints = 4000;
/// Side of the tiles of the picture whose errors count as one block: more than twice the distance
/// of the default scan's lines (2.5 mm) and frames (3 mm) at 75 mm.
inline constexpr double kErrorBlock_m = 8e-3;

/// The number of the tile that a pixel lies in.
std::int64_t error_block(const render::Camera& camera, int column, int row);

/// Registers pictures of one phantom in one placement, which it prepares once.
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
