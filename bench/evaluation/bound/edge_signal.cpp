#include "bench/evaluation/bound/edge_signal.h"

#include <cmath>
#include <utility>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

/// Farther behind a surface than any beam is wide.
constexpr double kDeep_m = 1;

/// Of the echo, with its power. `even`: the pair deep in the tissue.
PairValue echo(const EdgeSignal& signal, const PairValue& pair, const PairValue& even) {
  const double step = signal.tissue_power - signal.fluid_power;
  return {signal.fluid_power * even.covariance + step * pair.covariance, step * pair.slope_per_m};
}

}  // namespace

EdgeRise gaussian_rise(double sigma_m) {
  return [sigma_m](double behind_m) -> RiseValue {
    const double u = behind_m / sigma_m;
    return {0.5 * std::erfc(-u / std::sqrt(2.0)),
            std::exp(-0.5 * u * u) / (std::sqrt(2 * kPi) * sigma_m)};
  };
}

SpeckleCorrelation gaussian_correlation(double pulse_sigma_m) {
  return [pulse_sigma_m](double distance_m) {
    const double u = distance_m / (2 * pulse_sigma_m);
    return std::exp(-u * u);
  };
}

EdgePair pulse_after_edge(SpeckleCorrelation correlation, EdgeRise rise) {
  return [correlation = std::move(correlation), rise = std::move(rise)](
             double behind_m, double distance_m) -> PairValue {
    const RiseValue at = rise(behind_m);
    const double together = correlation(distance_m);
    return {together * at.share, together * at.slope_per_m};
  };
}

EdgePair edge_after_pulse(SpeckleCorrelation correlation, EdgeRise rise) {
  return [correlation = std::move(correlation), rise = std::move(rise)](
             double behind_m, double distance_m) -> PairValue {
    const RiseValue a = rise(behind_m - 0.5 * distance_m), b = rise(behind_m + 0.5 * distance_m);
    const double mean = std::sqrt(a.share * b.share), together = correlation(distance_m);
    if (mean == 0) return {};
    const double slope_per_m = 0.5 * (a.slope_per_m * b.share + b.slope_per_m * a.share) / mean;
    return {together * mean, together * slope_per_m};
  };
}

EdgeCovariance edge_covariance(const EdgeSignal& signal,
                               double edge_m,
                               double first_m,
                               int samples) {
  EdgeCovariance result{SquareMatrix(samples), SquareMatrix(samples)};
  for (int lag = 0; lag < samples; ++lag) {
    const double distance_m = lag * signal.spacing_m;
    const PairValue even = signal.pair(kDeep_m, distance_m);
    if (std::norm(even.covariance) < 1e-30) break;  // no pulse is so long
    for (int i = 0; i + lag < samples; ++i) {
      const int j = i + lag;
      const double behind_m = first_m + i * signal.spacing_m + 0.5 * distance_m - edge_m;
      const PairValue pair = echo(signal, signal.pair(behind_m, distance_m), even);
      const double noise = lag == 0 ? signal.noise_power : 0;
      result.value.at(i, j) = pair.covariance + noise;
      result.value.at(j, i) = std::conj(pair.covariance) + noise;
      // A surface farther away is less far ahead of the sample.
      result.derivative.at(i, j) = -pair.slope_per_m;
      result.derivative.at(j, i) = -std::conj(pair.slope_per_m);
    }
  }
  return result;
}

EdgePower edge_power(const EdgeSignal& signal, double edge_m, double first_m, int samples) {
  EdgePower result;
  const PairValue even = signal.pair(kDeep_m, 0);
  for (int i = 0; i < samples; ++i) {
    const double behind_m = first_m + i * signal.spacing_m - edge_m;
    const PairValue power = echo(signal, signal.pair(behind_m, 0), even);
    result.value.push_back(power.covariance.real() + signal.noise_power);
    result.derivative.push_back(-power.slope_per_m.real());
  }
  return result;
}

}  // namespace wobblebench::bench
