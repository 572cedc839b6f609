#include "bench/evaluation/bound/detection_bound.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

/// Eigenvalues below this share of the largest are rounding errors.
constexpr double kLeastMode = 1e-10;

/// Of the sticks within half a beam's width of the middle one, in one direction.
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

}  // namespace

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

}  // namespace wobblebench::bench
