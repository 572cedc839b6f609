#include "bench/evaluation/bound/detection_bound.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "base/units.h"
#include "sim/optics/beam_profile.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

/// Positions of the surface between two samples.
constexpr int kPhases = 4;
/// This many sigmas before its middle a Gaussian rise is 98 dB below its plateau.
constexpr double kBeforeSigmas = 6.2;
constexpr double kBehindSigmas = 4.5;
/// Eigenvalues below this share of the largest are rounding errors.
constexpr double kLeastMode = 1e-10;
/// Spacing where there is no neighbour.
constexpr double kAlone_m = 1;

double power_of_db(double db) {
  return db <= sim::kZeroAmplitude_db ? 0 : std::pow(10.0, db / 10);
}

double pulse_sigma_m(const DetectionConditions& conditions) {
  return sim::sigma_of_fwhm(conditions.pulse_fwhm_m);
}

void require(bool allowed, const std::string& field, double value, const std::string& range) {
  if (allowed) return;
  throw std::invalid_argument("detection_bound_m: " + field + " = " + significant(value, 6) + ": " +
                              range);
}

/// Eigenvalues for the sticks within half a beam's width of the middle one, in one direction.
std::vector<double> modes_along(double fwhm_m, double spacing_m) {
  const int side = static_cast<int>(0.5 * fwhm_m / spacing_m), sticks = 2 * side + 1;
  const auto correlation = gaussian_correlation(sim::sigma_of_fwhm(fwhm_m));
  Eigen::MatrixXd matrix(sticks, sticks);
  for (int i = 0; i < sticks; ++i) {
    for (int j = 0; j < sticks; ++j) matrix(i, j) = correlation((i - j) * spacing_m);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix, Eigen::EigenvaluesOnly);
  return {solver.eigenvalues().begin(), solver.eigenvalues().end()};
}

/// Mean square echo of a material of this mean echo.
double speckle_power_db(double mean_echo_db) {
  // A Rayleigh envelope's mean squared is pi / 4 of its mean square.
  return mean_echo_db + 10 * std::log10(4 / kPi);
}

}  // namespace

void validate(const DetectionConditions& c) {
  const auto positive = [](const std::string& field, double value) {
    require(value > 0 && std::isfinite(value), field, value, "must be positive");
  };
  require(c.incidence_rad >= 0 && c.incidence_rad <= kMostIncidence_rad + 1e-9,
          "incidence_rad",
          c.incidence_rad,
          "must be within 0 and 80 degrees");
  positive("lateral_fwhm_m", c.lateral_fwhm_m);
  positive("elevation_fwhm_m", c.elevation_fwhm_m);
  positive("pulse_fwhm_m", c.pulse_fwhm_m);
  positive("sample_spacing_m", c.sample_spacing_m);
  require(c.sample_spacing_m >= c.pulse_fwhm_m / 50,
          "sample_spacing_m",
          c.sample_spacing_m,
          "must be at least a fiftieth of pulse_fwhm_m");
  positive("line_spacing_m", c.line_spacing_m);
  positive("frame_spacing_m", c.frame_spacing_m);
  const double below_db = std::max(c.noise_db, c.fluid_db);
  require(c.noise_db >= c.tissue_db - 80 && std::isfinite(c.noise_db),
          "noise_db",
          c.noise_db,
          "must be at most 80 dB below tissue_db: without noise the bound is 0");
  require(c.tissue_db > below_db - 30 && c.tissue_db != c.fluid_db && std::isfinite(c.tissue_db),
          "tissue_db",
          c.tissue_db,
          "must be no more than 30 dB below noise and fluid, and another than the fluid's");
}

double rise_sigma_m(const DetectionConditions& c) {
  const double pulse_m = sim::power_sigma(c.pulse_fwhm_m);
  const double slope = std::tan(c.incidence_rad);
  const double lateral_m = sim::power_sigma(c.lateral_fwhm_m) * slope * std::cos(c.azimuth_rad);
  const double elevation_m = sim::power_sigma(c.elevation_fwhm_m) * slope * std::sin(c.azimuth_rad);
  return std::hypot(pulse_m, lateral_m, elevation_m);
}

EdgeSignal edge_signal(const DetectionConditions& c) {
  return {.tissue_power = power_of_db(c.tissue_db),
          .fluid_power = power_of_db(c.fluid_db),
          .noise_power = power_of_db(c.noise_db),
          .spacing_m = c.sample_spacing_m,
          .pair = pulse_after_edge(gaussian_correlation(pulse_sigma_m(c)),
                                   gaussian_rise(rise_sigma_m(c)))};
}

SampleWindow sample_window(const DetectionConditions& c) {
  const double pulse_m = 4 * pulse_sigma_m(c), rise_m = rise_sigma_m(c);
  const double before_m = kBeforeSigmas * rise_m + pulse_m;
  const double length_m = before_m + kBehindSigmas * rise_m + pulse_m;
  return {-before_m, static_cast<int>(std::ceil(length_m / c.sample_spacing_m)) + 1};
}

std::vector<double> neighbour_modes(const DetectionConditions& conditions) {
  std::vector<double> modes;
  double most = 0;
  const auto lines = modes_along(conditions.lateral_fwhm_m, conditions.line_spacing_m);
  const auto frames = modes_along(conditions.elevation_fwhm_m, conditions.frame_spacing_m);
  for (const double line : lines) {
    for (const double frame : frames) {
      modes.push_back(line * frame);
      most = std::max(most, modes.back());
    }
  }
  std::erase_if(modes, [&](double mode) { return mode < kLeastMode * most; });
  return modes;
}

double detection_bound_m(const DetectionConditions& conditions) {
  validate(conditions);
  const std::vector<double> modes = neighbour_modes(conditions);
  const EdgeSignal stick = edge_signal(conditions);
  const SampleWindow window = sample_window(conditions);
  double sum = 0;
  for (int phase = 0; phase < kPhases; ++phase) {
    const double edge_m = (phase + 0.5) / kPhases * conditions.sample_spacing_m;
    double information = 0;
    for (const double mode : modes) {
      EdgeSignal signal = stick;
      signal.tissue_power *= mode;
      signal.fluid_power *= mode;
      const auto covariance = edge_covariance(signal, edge_m, window.first_m, window.count);
      information += covariance_information(covariance.value, covariance.derivative);
    }
    sum += 1 / information;
  }
  return std::sqrt(sum / kPhases);
}

StickSlope stick_slope(const hw::PolarPoint& point,
                       const hw::ProbeGeometry& geometry,
                       const glm::dvec3& normal) {
  const glm::dvec3 axis = geometry.stick(point.theta_rad, point.phi_rad).direction;
  // Across the image plane, which turns about an axis parallel to x.
  const glm::dvec3 elevation(0, -std::cos(point.phi_rad), -std::sin(point.phi_rad));
  const glm::dvec3 lateral = glm::cross(axis, elevation);
  const double along = std::abs(glm::dot(normal, axis));
  const double across = std::hypot(glm::dot(normal, lateral), glm::dot(normal, elevation));
  const double most = across > 0 ? std::tan(kMostIncidence_rad) / across : 0;
  const double scale = std::min(1 / std::max(along, 1e-12), most);
  return {scale * glm::dot(normal, lateral), scale * glm::dot(normal, elevation)};
}

DetectionConditions conditions_at(const hw::AcquisitionPlan& plan,
                                  const sim::BeamProfile& profile,
                                  const sim::SimulationOptions& options,
                                  const hw::PolarPoint& point,
                                  const glm::dvec3& normal,
                                  double tissue_mean_db) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const StickSlope slope = stick_slope(point, geometry, normal);
  const double level = profile.level(point.range_m, point.theta_rad);
  const double radius_m = geometry.radius_m() + point.range_m;
  const double from_axis_m = radius_m * std::cos(point.theta_rad) - geometry.axis_z_m();
  const auto spacing_m = [](double arc_m) { return arc_m > 0 ? arc_m : kAlone_m; };
  return {.incidence_rad = std::atan(std::hypot(slope.lateral, slope.elevation)),
          .azimuth_rad = std::atan2(slope.elevation, slope.lateral),
          .tissue_db = speckle_power_db(tissue_mean_db) + 20 * std::log10(level),
          .noise_db = options.noise_db,
          .lateral_fwhm_m = profile.lateral_fwhm_m(point.range_m, point.theta_rad),
          .elevation_fwhm_m = profile.elevation_fwhm_m(point.range_m),
          .pulse_fwhm_m = sim::axial_fwhm_m(plan),
          .sample_spacing_m = plan.sample_spacing_m() / sim::iq_oversampling(plan),
          .line_spacing_m = spacing_m(radius_m * plan.theta_step_rad()),
          .frame_spacing_m = spacing_m(from_axis_m * plan.phi_step_rad())};
}

}  // namespace wobblebench::bench
