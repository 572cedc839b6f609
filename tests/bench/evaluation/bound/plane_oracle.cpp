#include "tests/bench/evaluation/bound/plane_oracle.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "base/parallel.h"
#include "base/statistics.h"
#include "base/units.h"
#include "tests/bench/evaluation/bound/plane_scan.h"

namespace wobblebench::bench {

namespace {

/// Half a bound a step, as far as the rise is wide and no less than 12 bounds.
SearchGrid search_about(const PlaneStick& stick) {
  const double step_m = 0.5 * stick.bound_m;
  const double reach_m = std::max(12 * stick.bound_m, 2 * rise_sigma_m(stick.conditions));
  const int side = static_cast<int>(std::ceil(reach_m / step_m));
  return {stick.edge_m - side * step_m, step_m, 2 * side + 1};
}

std::vector<std::vector<double>> oracle_errors(const PlaneScan& scan) {
  const auto samples = scan.samples();
  std::vector<std::vector<double>> errors(samples.size());
  parallel_rows(static_cast<int>(samples.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    const PlaneStick& stick = scan.sticks()[at];
    errors[at] = most_likely_edges_m([&](double edge_m) { return scan.signal_at(stick, edge_m); },
                                     stick.first_m,
                                     samples[at],
                                     search_about(stick));
    for (double& error : errors[at]) error -= stick.edge_m;
  });
  return errors;
}

/// Mean squares of a lone stick's bounds.
void add_bounds(const PlaneScan& scan, PlaneBound& result) {
  std::vector<double> bounds, rung_bounds, envelopes;
  for (const PlaneStick& stick : scan.sticks()) {
    bounds.push_back(detection_bound_m(stick.conditions));
    rung_bounds.push_back(stick.bound_m);
    envelopes.push_back(envelope_bound_m(stick.conditions, scan.plan().sample_spacing_m()));
  }
  result.bound_m = root_mean_square(bounds);
  result.rung_bound_m = root_mean_square(rung_bounds);
  result.envelope_m = root_mean_square(envelopes);
}

/// The interval is that of the mean of independent squares.
void add_ratio(const std::vector<double>& errors, PlaneBound& result) {
  const auto n = static_cast<double>(errors.size());
  const double rms_m = root_mean_square(errors), mean2 = rms_m * rms_m;
  double spread = 0;
  for (const double error : errors) spread += (error * error - mean2) * (error * error - mean2);
  const double half = 1.96 * std::sqrt(spread / (n - 1) / n) / mean2;
  result.n = static_cast<int>(errors.size());
  result.oracle_rms_m = rms_m;
  result.oracle_bias_m = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  result.ratio = rms_m / result.bound_m;
  result.ratio_low = result.ratio * std::sqrt(std::max(0.0, 1 - half));
  result.ratio_high = result.ratio * std::sqrt(1 + half);
  result.rung_ratio = rms_m / result.rung_bound_m;
}

}  // namespace

PlaneBound measure_plane_bound(const PlaneCell& cell) {
  if (cell.rung != sim::Rung::field && cell.rung != sim::Rung::scatterers) {
    throw std::invalid_argument("measure_plane_bound: rung: must be field or scatterers");
  }
  if (!(std::abs(cell.incidence_rad) <= 60 * kDegree + 1e-9)) {
    throw std::invalid_argument("measure_plane_bound: incidence_rad: must be at most 60 degrees");
  }
  const PlaneScan scan(cell);
  std::vector<double> errors;
  for (const auto& of_stick : oracle_errors(scan)) {
    errors.insert(errors.end(), of_stick.begin(), of_stick.end());
  }
  PlaneBound result;
  add_bounds(scan, result);
  add_ratio(errors, result);
  return result;
}

}  // namespace wobblebench::bench
