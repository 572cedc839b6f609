#include "sim/speckle/speckle_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/optics/point_spread.h"
#include "sim/speckle/field_correlation.h"

namespace wobblebench::sim {

namespace {

constexpr double kRangeStep_m = 5e-3;
constexpr double kAngleStep_rad = 3.3 * kDegree;
constexpr double kUncorrelated = 0.02;
constexpr int kSampledLags = 16;  ///< over the first lobe; correlations between are interpolated

/// At lags 0, 1, ..., until it stays small. The phase that grows with the lag, of an aperture that
/// is not even, does not change the envelope.
std::vector<double> correlations(const FieldCorrelation& correlation, const Turn& turn) {
  const int stride =
      std::max(1, static_cast<int>(turn.coherence_rad / turn.step_rad) / kSampledLags);
  std::vector<double> sampled = {1};
  const int most = turn.most_lags / stride + 1;
  double phase_per_lag = 0;
  for (int n = 1; n <= most; ++n) {
    const std::complex<double> at = correlation.at(n * stride * turn.step_rad);
    if (n == 1) phase_per_lag = std::arg(at);
    sampled.push_back(std::real(at * std::polar(1.0, -n * phase_per_lag)));
    const double before = std::abs(sampled[sampled.size() - 2]);
    if (std::abs(at) < kUncorrelated && (stride == 1 || before < kUncorrelated)) break;
  }
  std::vector<double> lags;
  for (int lag = 0; lag <= std::min(turn.most_lags, static_cast<int>(sampled.size() - 1) * stride);
       ++lag) {
    const auto before = static_cast<std::size_t>(lag / stride);
    const double share = static_cast<double>(lag % stride) / stride;
    const double next = before + 1 < sampled.size() ? sampled[before + 1] : 0;
    lags.push_back((1 - share) * sampled[before] + share * next);
  }
  return lags;
}

/// Turning from the motor's axis, in the direction in which the frames turn.
Turn turn_of_frames(const hw::AcquisitionPlan& plan, double range_m, double theta_rad) {
  const auto& probe = plan.probe();
  const double cosine = std::cos(theta_rad);
  const double arm_m = std::abs((probe.radius_m + range_m) * cosine - plan.geometry().axis_z_m());
  const double lobe_m = wavelength_m(plan) * range_m / probe.element_height_m;
  return {plan.phi_step_rad(),
          plan.acquisition().frames_per_volume - 1,
          2 * lobe_m / std::max(arm_m, 1e-4),
          [=](double v, double angle) {
            const double turned_m = arm_m * std::cos(angle) + v * std::sin(angle);
            return PlanePoint{range_m + (turned_m - arm_m) * cosine,
                              v * std::cos(angle) - arm_m * std::sin(angle)};
          }};
}

std::vector<double> taps_at(const PulseBand& band,
                            const ElevationPlane& elevation,
                            const SampledRow& lateral,
                            const Turn& turn) {
  if (turn.step_rad <= 0 || turn.most_lags < 1) return {1};
  const FieldCorrelation correlation(elevation, lateral, turn, band);
  if (correlation.silent()) return {1};
  return taps_of_correlation(correlations(correlation, turn));
}

/// For each range and angle of the grid.
std::vector<std::vector<double>> all_taps(const BeamGrid& grid,
                                          const hw::AcquisitionPlan& plan,
                                          const SimulationOptions& options) {
  const PulseBand band(plan);
  const int angles = grid.angles();
  std::vector<std::vector<double>> taps(static_cast<std::size_t>(grid.ranges() * angles));
  const auto at_range = [&](int range) {
    const double range_m = grid.range_m(range);
    const ElevationPlane elevation(plan, band, options.apodisation, range_m);
    for (int angle = 0; angle < angles; ++angle) {
      const double theta_rad = grid.angle_rad(angle);
      taps[static_cast<std::size_t>(range * angles + angle)] =
          taps_at(band,
                  elevation,
                  lateral_row(plan, band, options.apodisation, range_m, theta_rad),
                  turn_of_frames(plan, range_m, theta_rad));
    }
  };
  parallel_ranges(grid.ranges(), options.threads, [&](int first, int last) {
    for (int range = first; range < last; ++range) at_range(range);
  });
  return taps;
}

int longest(const std::vector<std::vector<double>>& taps) {
  std::size_t most = 1;
  for (const auto& row : taps) most = std::max(most, row.size());
  return static_cast<int>(most);
}

}  // namespace

std::vector<double> taps_of_correlation(const std::vector<double>& correlation) {
  constexpr double kSmallTap = 0.01;
  const int lags = static_cast<int>(correlation.size()) - 1;
  if (lags == 0) return {1};
  const int period = 8 * lags + 8;
  std::vector<double> cosine;
  for (int i = 0; i < period; ++i) cosine.push_back(std::cos(2 * kPi * i / period));
  const auto cos_of = [&](int a, int b) {
    return cosine[static_cast<std::size_t>(static_cast<std::int64_t>(a) * b % period)];
  };
  std::vector<double> taps(static_cast<std::size_t>(3 * lags) + 1);
  for (int k = 0; k < period; ++k) {
    double spectrum = correlation[0];
    for (int n = 1; n <= lags; ++n) {
      spectrum += 2 * correlation[static_cast<std::size_t>(n)] * cos_of(k, n);
    }
    const double amplitude = std::sqrt(std::max(spectrum, 0.0));
    for (std::size_t m = 0; m < taps.size(); ++m) {
      taps[m] += amplitude * cos_of(k, static_cast<int>(m)) / period;
    }
  }
  while (taps.size() > 1 && std::abs(taps.back()) < kSmallTap * taps.front()) taps.pop_back();
  double power = -taps[0] * taps[0];
  for (double tap : taps) power += 2 * tap * tap;
  for (double& tap : taps) tap /= std::sqrt(power);
  return taps;
}

SpeckleKernels::SpeckleKernels(const hw::AcquisitionPlan& plan, const SimulationOptions& options)
    : grid_(plan, kRangeStep_m, kAngleStep_rad),
      taps_(all_taps(grid_, plan, options)),
      count_(longest(taps_)) {}

int SpeckleKernels::angle_of(double theta_rad) const {
  const BeamGrid::Between at = grid_.angle_at(theta_rad);
  return static_cast<int>(at.share < 0.5 ? at.first : at.second);
}

std::vector<float> SpeckleKernels::taps(double range_m, int angle) const {
  const BeamGrid::Between r = grid_.range_at(range_m);
  const auto angles = static_cast<std::size_t>(grid_.angles()), a = static_cast<std::size_t>(angle);
  const auto &first = taps_[r.first * angles + a], &second = taps_[r.second * angles + a];
  std::vector<double> mixed(std::max(first.size(), second.size()));
  double power = 0;
  for (std::size_t i = 0; i < mixed.size(); ++i) {
    mixed[i] = (1 - r.share) * (i < first.size() ? first[i] : 0) +
               r.share * (i < second.size() ? second[i] : 0);
    power += (i == 0 ? 1 : 2) * mixed[i] * mixed[i];
  }
  std::vector<float> unit;
  for (double tap : mixed) unit.push_back(static_cast<float>(tap / std::sqrt(power)));
  return unit;
}

}  // namespace wobblebench::sim
