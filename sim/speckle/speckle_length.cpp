#include "sim/speckle/speckle_length.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "sim/optics/point_spread.h"
#include "sim/speckle/field_correlation.h"

namespace wobblebench::sim {

namespace {

constexpr double kStep_m = 5e-3;

/// Deviation of the wavenumber over the band, each node times `power_of(node)`.
template <class PowerOf>
double deviation_per_m(const PulseBand& band, const PowerOf& power_of) {
  double sum = 0, first = 0, second = 0;
  for (int node = 0; node < band.nodes(); ++node) {
    const double weight = band.weight(node) * power_of(static_cast<std::size_t>(node));
    const double offset_per_m = band.offset_per_m(node);
    sum += weight;
    first += weight * offset_per_m;
    second += weight * offset_per_m * offset_per_m;
  }
  return sum > 0 ? std::sqrt(std::max(0.0, second / sum - first * first / sum / sum)) : 0;
}

/// Length of speckle over that of the pulse.
double length_ratio(const hw::AcquisitionPlan& plan,
                    const PulseBand& band,
                    Apodisation apodisation,
                    double range_m) {
  const ElevationPlane elevation(plan, band, apodisation, range_m);
  const auto across = node_powers(elevation.row);
  const auto along = node_powers(lateral_row(plan, band, apodisation, range_m, 0));
  const double sent = deviation_per_m(band, [](std::size_t) { return 1.0; });
  const double heard =
      deviation_per_m(band, [&](std::size_t node) { return along[node] * across[node]; });
  return heard > 0 ? sent / heard : 1;
}

}  // namespace

SpeckleLengths::SpeckleLengths(const hw::AcquisitionPlan& plan, const SimulationOptions& options)
    : step_m_(kStep_m) {
  const PulseBand band(plan);
  const double pulse_m = sigma_of_fwhm(axial_fwhm_m(plan));
  const int count = static_cast<int>(std::ceil(plan.acquisition().depth_m / step_m_)) + 1;
  sigmas_m_.resize(static_cast<std::size_t>(count));
  parallel_ranges(count, options.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      // At the face itself there is no beam yet.
      const double range_m = std::max(i, 1) * step_m_;
      sigmas_m_[static_cast<std::size_t>(i)] =
          pulse_m * length_ratio(plan, band, options.apodisation, range_m);
    }
  });
}

double SpeckleLengths::sigma_m(double range_m) const {
  const double place =
      std::clamp(range_m / step_m_, 0.0, static_cast<double>(sigmas_m_.size() - 1));
  const auto first = std::min(static_cast<std::size_t>(place), sigmas_m_.size() - 1);
  const auto second = std::min(first + 1, sigmas_m_.size() - 1);
  return std::lerp(sigmas_m_[first], sigmas_m_[second], place - static_cast<double>(first));
}

}  // namespace wobblebench::sim
