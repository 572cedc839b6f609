#include "bench/evaluation/bound/edge_signal.h"

#include <cmath>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

/// Power of the echo, without noise, at the distance of `rise`.
RiseValue echo_power(const EdgeSignal& signal, const RiseValue& rise) {
  const double step = signal.tissue_power - signal.fluid_power;
  return {signal.fluid_power + step * rise.share, step * rise.slope_per_m};
}

/// Covariance of two samples of fully correlated speckle, and its derivative by the distance behind
/// the surface.
RiseValue pair_power(const EdgeSignal& signal, double a_m, double b_m) {
  if (signal.order == SpeckleOrder::pulse_after_edge) {
    return echo_power(signal, signal.rise(0.5 * (a_m + b_m)));
  }
  const RiseValue a = echo_power(signal, signal.rise(a_m));
  const RiseValue b = echo_power(signal, signal.rise(b_m));
  const double mean = std::sqrt(a.share * b.share);
  if (mean == 0) return {};
  return {mean, 0.5 * (a.slope_per_m * b.share + b.slope_per_m * a.share) / mean};
}

}  // namespace

EdgeRise gaussian_rise(double sigma_m) {
  return [sigma_m](double behind_m) -> RiseValue {
    const double u = behind_m / sigma_m;
    return {0.5 * std::erfc(-u / std::sqrt(2.0)),
            std::exp(-0.5 * u * u) / (std::sqrt(2 * kPi) * sigma_m)};
  };
}

std::function<double(double)> gaussian_correlation(double pulse_sigma_m) {
  return [pulse_sigma_m](double distance_m) {
    const double u = distance_m / (2 * pulse_sigma_m);
    return std::exp(-u * u);
  };
}

EdgeCovariance edge_covariance(const EdgeSignal& signal,
                               double edge_m,
                               double first_m,
                               int samples) {
  EdgeCovariance result{SquareMatrix(samples), SquareMatrix(samples)};
  for (int lag = 0; lag < samples; ++lag) {
    const double correlation = signal.correlation(lag * signal.spacing_m);
    for (int i = 0; i + lag < samples; ++i) {
      const int j = i + lag;
      const double a_m = first_m + i * signal.spacing_m - edge_m;
      const RiseValue power = pair_power(signal, a_m, a_m + lag * signal.spacing_m);
      const double noise = lag == 0 ? signal.noise_power : 0;
      result.value.at(i, j) = result.value.at(j, i) = correlation * power.share + noise;
      // A surface farther away is less far ahead of the sample.
      result.derivative.at(i, j) = result.derivative.at(j, i) = -correlation * power.slope_per_m;
    }
  }
  return result;
}

EdgePower edge_power(const EdgeSignal& signal, double edge_m, double first_m, int samples) {
  EdgePower result;
  for (int i = 0; i < samples; ++i) {
    const RiseValue power =
        echo_power(signal, signal.rise(first_m + i * signal.spacing_m - edge_m));
    result.value.push_back(power.share + signal.noise_power);
    result.derivative.push_back(-power.slope_per_m);
  }
  return result;
}

}  // namespace wobblebench::bench
