#include "bench/evaluation/registration/registration.h"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/rotation.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/statistics.h"
#include "bench/evaluation/registration/uncertainty.h"

namespace wobblebench::bench {

namespace {

constexpr int kN = kRegistrationParameters;
constexpr double kHuber = 2.0;
/// Least standard deviation of the points that is believed: the voxels' and the picture's rounding.
constexpr double kLeastSigma_m = 20e-6;

using Values = std::array<double, kN>;

/// What all residuals share.
struct Frame {
  const DistanceTo& distance_to;
  hw::ProbeGeometry probe;
  glm::dvec3 centroid;
};

double value_of(double x) {
  return x;
}
template <class Jet>
double value_of(const Jet& x) {
  return x.a;
}

/// Position of the point by a probe with the fitted errors (hw::ProbeGeometry), minus the bias
/// along the picture's ray.
template <class T>
void unmoved_position(const MeasuredPoint& point,
                      const hw::ProbeGeometry& probe,
                      const T* p,
                      T* position) {
  const T r = T(probe.radius_m()) + T(point.polar.range_m) * (T(1) + p[kScale]);
  const T phi = T(point.polar.phi_rad) + p[kMotorAngle];
  const T axis_z = T(probe.axis_z_m()) - p[kWobbleRadius];
  const T axis_distance = r * T(std::cos(point.polar.theta_rad)) - axis_z;
  position[0] = r * T(std::sin(point.polar.theta_rad));
  position[1] = -axis_distance * sin(phi);
  position[2] = axis_z + axis_distance * cos(phi);
  for (int i = 0; i < 3; ++i) position[i] -= p[kBias] * T(point.view_direction[i]);
}

/// Signed distance of one transformed point to the surface, over the standard deviation of the
/// points.
struct SurfaceResidual {
  const MeasuredPoint& point;
  const Frame& frame;
  double sigma_m;

  template <class T>
  bool operator()(const T* parameters, T* residual) const {
    T offset[3], moved[3];
    unmoved_position(point, frame.probe, parameters, offset);
    for (int i = 0; i < 3; ++i) offset[i] -= T(frame.centroid[i]);
    ceres::AngleAxisRotatePoint(parameters + kRotation, offset, moved);
    glm::dvec3 position;
    for (int i = 0; i < 3; ++i) {
      moved[i] += T(frame.centroid[i]) + parameters[kTranslation + i];
      position[i] = value_of(moved[i]);
    }
    const auto distance = frame.distance_to(position, point.fired);
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
};

glm::dvec3 centroid_of(const std::vector<MeasuredPoint>& points, const hw::ProbeGeometry& probe) {
  glm::dvec3 sum(0);
  for (const auto& point : points) sum += probe.to_cartesian(point.polar);
  return sum / static_cast<double>(points.size());
}

void add_priors(ceres::Problem& problem, Values& values, const Values& sigma) {
  ceres::Matrix stiffness = ceres::Matrix::Zero(kN, kN);
  std::vector<int> held;
  for (int i = 0; i < kN; ++i) {
    const double width = sigma[static_cast<std::size_t>(i)];
    if (width > 0) {
      stiffness(i, i) = 1 / width;
    } else {
      held.push_back(i);
    }
  }
  problem.AddResidualBlock(
      new ceres::NormalPrior(stiffness, ceres::Vector::Zero(kN)), nullptr, values.data());
  if (!held.empty()) problem.SetManifold(values.data(), new ceres::SubsetManifold(kN, held));
}

/// One fit; `sigma_m`: assumed standard deviation of the points about the surface.
bool solve(Values& values,
           const std::vector<MeasuredPoint>& points,
           const Frame& frame,
           const Values& prior_sigma,
           double sigma_m) {
  ceres::Problem problem;
  for (const MeasuredPoint& point : points) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<SurfaceResidual, 1, kN>(
                                 new SurfaceResidual{point, frame, sigma_m}),
                             new ceres::HuberLoss(kHuber),
                             values.data());
  }
  add_priors(problem, values, prior_sigma);
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 50;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary.termination_type == ceres::CONVERGENCE;
}

/// RMS distance of the transformed points to the surface, limited to kFarPoint_m as in the fit.
double rms_distance_m(const std::vector<MeasuredPoint>& points,
                      const Frame& frame,
                      const Values& values) {
  double squares = 0;
  for (const MeasuredPoint& point : points) {
    double distance = 0;
    SurfaceResidual{point, frame, 1.0}(values.data(), &distance);
    squares += distance * distance;
  }
  return std::sqrt(squares / static_cast<double>(points.size()));
}

BlockAccumulator sums_by_block(const std::vector<MeasuredPoint>& points,
                               const Frame& frame,
                               const Values& values,
                               const Values& prior_sigma,
                               double sigma_m) {
  using Jet = ceres::Jet<double, kN>;
  std::array<Jet, kN> jets;
  for (int i = 0; i < kN; ++i) {
    jets[static_cast<std::size_t>(i)] = Jet(values[static_cast<std::size_t>(i)], i);
  }
  BlockAccumulator sums(kN, kHuber);
  for (const MeasuredPoint& point : points) {
    Jet residual;
    SurfaceResidual{point, frame, sigma_m}(jets.data(), &residual);
    Eigen::VectorXd derivatives = residual.v;
    for (int i = 0; i < kN; ++i) {
      if (!(prior_sigma[static_cast<std::size_t>(i)] > 0)) derivatives[i] = 0;
    }
    sums.add(point.block, residual.a, derivatives);
  }
  return sums;
}

/// Mean over the parameters' directions of their variance by blocks over that of independent
/// points; at least 1.
double inflation(const BlockAccumulator& sums, const Eigen::MatrixXd& regular) {
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(kN, kN);
  for (const BlockSums& block : sums.blocks()) {
    scatter += block.gradient * block.gradient.transpose();
  }
  const auto solver = regular.ldlt();
  const double by_blocks = solver.solve(scatter).trace();
  const double by_points = solver.solve(sums.hessian()).trace();
  return by_points > 0 ? std::max(1.0, by_blocks / by_points) : 1.0;
}

void read_intervals(const BlockAccumulator& sums, const Values& prior_sigma, Registration& result) {
  Eigen::VectorXd sigma(kN), precision(kN);
  for (int i = 0; i < kN; ++i) {
    sigma[i] = prior_sigma[static_cast<std::size_t>(i)];
    precision[i] = sigma[i] > 0 ? 1 / (sigma[i] * sigma[i]) : 0;
  }
  const BootstrapResult bootstrap = bootstrap_blocks(sums.blocks(), precision);
  result.blocks = static_cast<int>(sums.blocks().size());
  for (int i = 0; i < kN; ++i) {
    const auto slot = static_cast<std::size_t>(i);
    result.low[slot] = result.value[slot] + bootstrap.low[i];
    result.high[slot] = result.value[slot] + bootstrap.high[i];
    for (int j = 0; j < kN; ++j) {
      result.covariance[static_cast<std::size_t>(i * kN + j)] = bootstrap.covariance(i, j);
    }
  }
  Eigen::MatrixXd regular = sums.hessian();
  for (int i = 0; i < kN; ++i) regular(i, i) += precision[i] > 0 ? precision[i] : 1.0;
  result.variance_inflation = inflation(sums, regular);
  const auto seen =
      identifiability(sums.hessian() / result.variance_inflation, sigma, bootstrap.covariance);
  for (const auto& unseen : seen.unseen) {
    result.unseen.push_back({unseen.parameters, unseen.data_over_prior});
  }
  result.correlated = seen.correlated;
}

bool within_three_priors(const Values& value, const Values& sigma) {
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (std::abs(value[i]) > 3 * sigma[i]) return false;
  }
  return true;
}

}  // namespace

Registration::Registration()
    : rms_before_m(kUnset), rms_after_m(kUnset), variance_inflation(kUnset) {
  value.fill(kUnset);
  low.fill(kUnset);
  high.fill(kUnset);
  covariance.fill(kUnset);
}

double Registration::standard_deviation(int parameter) const {
  return std::sqrt(covariance.at(static_cast<std::size_t>(parameter * (kN + 1))));
}

double Registration::correlation(int one, int other) const {
  return covariance.at(static_cast<std::size_t>(one * kN + other)) /
         (standard_deviation(one) * standard_deviation(other));
}

const std::array<std::string, kN>& registration_names() {
  static const std::array<std::string, kN> names = {"rotation_x_rad",
                                                    "rotation_y_rad",
                                                    "rotation_z_rad",
                                                    "translation_x_m",
                                                    "translation_y_m",
                                                    "translation_z_m",
                                                    "scale_minus_1",
                                                    "bias_m",
                                                    "motor_angle_rad",
                                                    "wobble_radius_m"};
  return names;
}

Registration fit_probe(const std::vector<MeasuredPoint>& points,
                       const DistanceTo& distance_to,
                       const hw::ProbeGeometry& assumed,
                       const RegistrationPriors& priors) {
  Registration result;
  result.sampled = result.points = static_cast<int>(points.size());
  if (result.points < kLeastPoints) return result;
  const Frame frame{distance_to, assumed, centroid_of(points, assumed)};
  const Values sigma = priors.sigma();
  Values values{};
  result.rms_before_m = rms_distance_m(points, frame, values);
  // First with the RMS distance before the fit as sigma, then with the residual RMS, so that the
  // priors are weighed against the noise and not against the error that the first fit explained.
  double sigma_m = std::max(kLeastSigma_m, result.rms_before_m);
  for (int round = 0; round < 2; ++round) {
    result.converged = solve(values, points, frame, sigma, sigma_m);
    result.rms_after_m = rms_distance_m(points, frame, values);
    if (round == 0) sigma_m = std::max(kLeastSigma_m, result.rms_after_m);
  }
  result.value = values;
  result.within_priors = within_three_priors(values, sigma);
  read_intervals(sums_by_block(points, frame, values, sigma, sigma_m), sigma, result);
  return result;
}

}  // namespace wobblebench::bench
