#include "bench/evaluation/registration.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/rotation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "bench/evaluation/scanned_surfaces.h"

namespace wobblebench::bench {

namespace {

constexpr int kLeastPoints = 20;
/// Measured points farther than this from every target surface belong to none of them.
constexpr double kFarPoint_m = 6e-3;
/// Additional reach for points that move away from the surface during the fit.
constexpr double kDrift_m = 1e-3;
constexpr double kUnset = std::numeric_limits<double>::quiet_NaN();

/// A point of the measured surface.
struct MeasuredPoint {
  hw::Ray stick;              ///< through the point, from the probe's face
  double range_m;             ///< along that
  glm::dvec3 view_direction;  ///< of the pixel's ray
  hw::StickIndex fired;       ///< the stick whose time the point has
  glm::dvec3 position() const { return stick.at(range_m); }
};

/// Signed distance of one transformed point to the surface, over the standard deviation of the
/// points.
struct SurfaceResidual {
  const MeasuredPoint& point;
  const ScannedSurfaces& target;
  glm::dvec3 centroid;
  double sigma_m;

  template <class T>
  bool operator()(
      const T* rotation, const T* translation, const T* scale, const T* bias, T* residual) const {
    T offset[3], moved[3];
    for (int i = 0; i < 3; ++i) {
      offset[i] = point.stick.origin[i] +
                  point.stick.direction[i] * (T(point.range_m) * (T(1) + scale[0])) -
                  bias[0] * point.view_direction[i] - centroid[i];
    }
    ceres::AngleAxisRotatePoint(rotation, offset, moved);
    glm::dvec3 position;
    for (int i = 0; i < 3; ++i) {
      moved[i] += T(centroid[i]) + translation[i];
      position[i] = value_of(moved[i]);
    }
    const auto distance = target.distance(position, point.fired);
    if (!distance) {
      residual[0] = T(kFarPoint_m / sigma_m);
      return true;
    }
    // First-order expansion: the distance, and its gradient times the derivatives of the position.
    residual[0] = T(distance->value_m);
    for (int i = 0; i < 3; ++i) residual[0] += distance->gradient[i] * (moved[i] - T(position[i]));
    residual[0] /= T(sigma_m);
    return true;
  }

  /// The value without derivatives.
  static double value_of(double x) { return x; }
  template <class Jet>
  static double value_of(const Jet& x) {
    return x.a;
  }
};

std::vector<MeasuredPoint> measured_points(const Image<float>& depth_m,
                                           const hw::AcquisitionPlan& plan,
                                           const render::Camera& camera,
                                           const ScannedSurfaces& target,
                                           int max_points,
                                           int& sampled) {
  const double per_point = static_cast<double>(depth_m.pixels.size()) / max_points;
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(per_point))));
  std::vector<MeasuredPoint> points;
  for (int row = stride / 2; row < depth_m.height; row += stride) {
    for (int column = stride / 2; column < depth_m.width; column += stride) {
      const double depth = static_cast<double>(depth_m.at(column, row));
      if (!std::isfinite(depth)) continue;
      ++sampled;
      const hw::Ray ray = camera.ray(column, row);
      const hw::StickIndex fired = target.stick_at(ray.at(depth));
      const auto distance = target.distance(ray.at(depth), fired);
      if (!distance || std::abs(distance->value_m) > kFarPoint_m) continue;
      const hw::PolarPoint polar = plan.geometry().to_polar(ray.at(depth));
      points.push_back({plan.geometry().stick(polar.theta_rad, polar.phi_rad),
                        polar.range_m,
                        ray.direction,
                        fired});
    }
  }
  return points;
}

/// The parameter blocks of the fit, laid out as Registration::value.
struct Blocks {
  std::array<double, kRegistrationParameters> value{};
  double* rotation() { return value.data(); }
  double* translation() { return value.data() + 3; }
  double* scale() { return value.data() + 6; }
  double* bias() { return value.data() + 7; }
};

void add_prior(ceres::Problem& problem, double* block, int size, double sigma) {
  ceres::Matrix stiffness = ceres::Matrix::Identity(size, size) / sigma;
  problem.AddResidualBlock(
      new ceres::NormalPrior(stiffness, ceres::Vector::Zero(size)), nullptr, block);
}

bool within_three_priors(const RegistrationPriors& priors,
                         const std::array<double, kRegistrationParameters>& value) {
  const std::array<double, kRegistrationParameters> width = {priors.rotation_rad,
                                                             priors.rotation_rad,
                                                             priors.rotation_rad,
                                                             priors.translation_m,
                                                             priors.translation_m,
                                                             priors.translation_m,
                                                             priors.scale,
                                                             priors.bias_m};
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (std::abs(value[i]) > 3 * width[i]) return false;
  }
  return true;
}

/// One fit; `sigma_m`: assumed standard deviation of the points about the surface.
ceres::Solver::Summary solve(ceres::Problem& problem,
                             Blocks& blocks,
                             const std::vector<MeasuredPoint>& points,
                             const ScannedSurfaces& target,
                             const glm::dvec3& centroid,
                             const RegistrationPriors& priors,
                             double sigma_m) {
  for (const MeasuredPoint& point : points) {
    auto* residual = new SurfaceResidual{point, target, centroid, sigma_m};
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<SurfaceResidual, 1, 3, 3, 1, 1>(residual),
        new ceres::HuberLoss(2.0),
        blocks.rotation(),
        blocks.translation(),
        blocks.scale(),
        blocks.bias());
  }
  add_prior(problem, blocks.rotation(), 3, priors.rotation_rad);
  add_prior(problem, blocks.translation(), 3, priors.translation_m);
  add_prior(problem, blocks.scale(), 1, priors.scale);
  add_prior(problem, blocks.bias(), 1, priors.bias_m);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

void read_covariance(ceres::Problem& problem, Blocks& blocks, Registration& result) {
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  const std::vector<const double*> all = {
      blocks.rotation(), blocks.translation(), blocks.scale(), blocks.bias()};
  result.converged = covariance.Compute(all, &problem) &&
                     covariance.GetCovarianceMatrix(all, result.covariance.data()) &&
                     result.converged;
}

/// RMS distance of the transformed points to the surface, limited to kFarPoint_m as in the fit.
double rms_distance_m(const std::vector<MeasuredPoint>& points,
                      const ScannedSurfaces& target,
                      const glm::dvec3& centroid,
                      const Blocks& parameters) {
  Blocks blocks = parameters;
  double squares = 0;
  for (const MeasuredPoint& point : points) {
    double distance = 0;
    SurfaceResidual{point, target, centroid, 1.0}(
        blocks.rotation(), blocks.translation(), blocks.scale(), blocks.bias(), &distance);
    squares += distance * distance;
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

}  // namespace

Registration::Registration() : rms_before_m(kUnset), rms_after_m(kUnset) {
  value.fill(kUnset);
  covariance.fill(kUnset);
}

double Registration::standard_deviation(int parameter) const {
  const auto diagonal = static_cast<std::size_t>(parameter * (kRegistrationParameters + 1));
  return std::sqrt(covariance.at(diagonal));
}

const std::array<std::string, kRegistrationParameters>& registration_names() {
  static const std::array<std::string, kRegistrationParameters> names = {"rotation_x_rad",
                                                                         "rotation_y_rad",
                                                                         "rotation_z_rad",
                                                                         "translation_x_m",
                                                                         "translation_y_m",
                                                                         "translation_z_m",
                                                                         "scale_minus_1",
                                                                         "bias_m"};
  return names;
}

Registration register_surface(const Image<float>& depth_m,
                              const phantoms::PlacedPhantom& subject,
                              const hw::AcquisitionPlan& plan,
                              const render::View& view,
                              const RegistrationPriors& priors,
                              int max_points,
                              std::uint32_t volume) {
  const ScannedSurfaces target(subject, plan, view, kFarPoint_m + kDrift_m, volume);
  Registration result;
  const auto points =
      measured_points(depth_m, plan, view.camera, target, max_points, result.sampled);
  result.points = static_cast<int>(points.size());
  if (result.points < kLeastPoints) return result;

  glm::dvec3 centroid(0);
  for (const auto& point : points)
    centroid += point.position() / static_cast<double>(points.size());
  Blocks blocks;
  result.rms_before_m = rms_distance_m(points, target, centroid, blocks);
  // First with the RMS distance before the fit as sigma, then with the residual RMS, so that the
  // covariance describes the noise and not the error that the first fit explained.
  double sigma_m = std::max(1e-6, result.rms_before_m);
  for (int round = 0; round < 2; ++round) {
    ceres::Problem problem;
    const auto summary = solve(problem, blocks, points, target, centroid, priors, sigma_m);
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.rms_after_m = rms_distance_m(points, target, centroid, blocks);
    sigma_m = std::max(1e-6, result.rms_after_m);
    if (round == 1) read_covariance(problem, blocks, result);
  }
  result.value = blocks.value;
  result.within_priors = within_three_priors(priors, blocks.value);
  return result;
}

}  // namespace wobblebench::bench
