#include "bench/evaluation/bound/edge_signal.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/units.h"

namespace wobblebench::bench {

namespace {

/// Farther behind a surface than any beam is wide.
constexpr double kDeep_m = 1;

/// The pair with the powers of fluid and tissue. `deep`: the pair far behind the surface.
PairValue echo(const EdgeSignal& signal, const PairValue& pair, const PairValue& deep) {
  const double step = signal.tissue_power - signal.fluid_power;
  return {signal.fluid_power * deep.covariance + step * pair.covariance, step * pair.slope_per_m};
}

using RowMajor =
    Eigen::Matrix<std::complex<double>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Map<const RowMajor> view(const SquareMatrix& matrix) {
  return {matrix.values.data(), matrix.size, matrix.size};
}

bool is_real(const SquareMatrix& matrix) {
  return std::ranges::all_of(matrix.values, [](const auto& value) { return value.imag() == 0; });
}

template <class Matrix>
double information_of(const Matrix& covariance, const Matrix& derivative) {
  const Eigen::LLT<Matrix> root(covariance);
  if (root.info() != Eigen::Success) {
    throw std::domain_error("covariance_information: the covariance is not positive definite");
  }
  const Matrix change = root.solve(derivative);
  return std::real(change.cwiseProduct(change.transpose()).sum());
}

}  // namespace

double covariance_information(const SquareMatrix& covariance, const SquareMatrix& derivative) {
  if (is_real(covariance) && is_real(derivative)) {  // four times as fast
    return information_of<Eigen::MatrixXd>(view(covariance).real(), view(derivative).real());
  }
  return information_of<Eigen::MatrixXcd>(view(covariance), view(derivative));
}

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

EdgeCovariance edge_covariance(const EdgeSignal& signal,
                               double edge_m,
                               double first_m,
                               int samples) {
  EdgeCovariance result{SquareMatrix(samples), SquareMatrix(samples)};
  for (int lag = 0; lag < samples; ++lag) {
    const double distance_m = lag * signal.spacing_m;
    const PairValue deep = signal.pair(kDeep_m, distance_m);
    if (std::norm(deep.covariance) < 1e-30) break;  // no pulse is so long
    for (int i = 0; i + lag < samples; ++i) {
      const int j = i + lag;
      const double behind_m = first_m + i * signal.spacing_m + 0.5 * distance_m - edge_m;
      const PairValue pair = echo(signal, signal.pair(behind_m, distance_m), deep);
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

}  // namespace wobblebench::bench
