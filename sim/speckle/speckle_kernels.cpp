#include "sim/speckle/speckle_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/math/fast_math.h"
#include "sim/optics/beam_row.h"

namespace wobblebench::sim {

namespace {

constexpr double kKernelRangeStep_m = 5e-3;
constexpr double kAngleStep_rad = 3.3 * kDegree;
constexpr double kUncorrelated = 0.02;
constexpr int kSampledLags =
    16;  ///< over the first lobe; correlations between them are interpolated
constexpr double kLengthStep_m = 5e-3;  ///< between the ranges of SpeckleLengths

std::complex<double> unit_phasor(double phase_rad) {
  const CosSin at = cos_sin_of_cycles(static_cast<float>(phase_rad / (2 * kPi)));
  return {static_cast<double>(at.cosine), static_cast<double>(at.sine)};
}

/// A turn of the stick past a range.
struct Turn {
  double step_rad;       ///< between neighbours
  int most_lags;         ///< number of neighbours
  double coherence_rad;  ///< turn over which the field decorrelates, approximately
  /// Position, relative to a stick turned by an angle, of the scatterer at an offset at the range.
  std::function<PlanePoint(double offset_m, double turn_rad)> point;
};

/// Correlation of the fields of two sticks that differ by a turn across the image plane: the
/// integral of h1 conj(h2) over the positions of scatterers, 1 for no turn. Each frequency is
/// weighted by its power in the image plane.
class FieldCorrelation {
 public:
  /// All must outlive it.
  FieldCorrelation(const ElevationRow& elevation,
                   const SampledRow& lateral,
                   const Turn& turn,
                   const PulseBand& band);

  /// True if the stick has no aperture, as beyond the end of the array.
  bool silent() const { return !(power_ > 0); }
  std::complex<double> at(double turn_rad) const;

 private:
  /// Responses of a turned stick to the scatterers of the row.
  struct Responses {
    double middle_m;  ///< axial position of the scatterer at offset 0
    std::vector<PlanePoint> points;
    std::vector<PulseBand::Values> values;
  };
  Responses turned(double turn_rad) const;
  double power(const Responses& responses) const;
  /// Not normalised.
  std::complex<double> product(const Responses& here, const Responses& there) const;

  const ElevationRow& elevation_;
  const Turn& turn_;
  std::array<double, PulseBand::kNodes> weights_, wavenumber_per_m_;
  double power_ = 0;
};

FieldCorrelation::FieldCorrelation(const ElevationRow& elevation,
                                   const SampledRow& lateral,
                                   const Turn& turn,
                                   const PulseBand& band)
    : elevation_(elevation), turn_(turn), weights_(lateral.node_powers()) {
  for (std::size_t node = 0; node < weights_.size(); ++node) {
    weights_[node] *= band.weight(static_cast<int>(node));
    wavenumber_per_m_[node] = band.wavenumber_per_m(static_cast<int>(node));
  }
  power_ = power(turned(0));
}

FieldCorrelation::Responses FieldCorrelation::turned(double turn_rad) const {
  const SampledRow& row = elevation_.row;
  Responses turned{turn_.point(0, turn_rad).axial_m, {}, {}};
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    turned.points.push_back(turn_.point(row.offset_m(i), turn_rad));
  }
  turned.values = turn_rad == 0 ? row.values : elevation_.response.at(turned.points);
  return turned;
}

double FieldCorrelation::power(const Responses& responses) const {
  double sum = 0;
  for (const auto& value : responses.values) {
    for (std::size_t n = 0; n < weights_.size(); ++n) sum += weights_[n] * std::norm(value[n]);
  }
  return sum;
}

std::complex<double> FieldCorrelation::product(const Responses& here,
                                               const Responses& there) const {
  // The common axial shift of all scatterers is a phase of the whole field.
  const double common_m = there.middle_m - here.middle_m;
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < there.values.size(); ++i) {
    const double nearer_m = there.points[i].axial_m - here.points[i].axial_m - common_m;
    for (std::size_t n = 0; n < weights_.size(); ++n) {
      const std::complex<double> phasor = unit_phasor(2 * wavenumber_per_m_[n] * nearer_m);
      sum += times(weights_[n] * times(here.values[i][n], std::conj(there.values[i][n])), phasor);
    }
  }
  return sum;
}

std::complex<double> FieldCorrelation::at(double turn_rad) const {
  return product(turned(0), turned(turn_rad)) / power_;
}

/// Correlations at lags 0, 1, ..., until they stay small. The phase of an asymmetric aperture,
/// which grows linearly with the lag, does not change the envelope and is removed.
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

/// The turn about the motor's axis from frame to frame.
Turn turn_of_frames(const ProbeOptics& optics, double range_m, double theta_rad) {
  const auto& plan = optics.plan();
  const auto& probe = plan.probe();
  const double cosine = std::cos(theta_rad);
  const double arm_m = std::abs((probe.radius_m + range_m) * cosine - plan.geometry().axis_z_m());
  const double lobe_m = optics.wavelength_m() * range_m / probe.element_height_m;
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
                            const ElevationRow& elevation,
                            const SampledRow& lateral,
                            const Turn& turn) {
  if (turn.step_rad <= 0 || turn.most_lags < 1) return {1};
  const FieldCorrelation correlation(elevation, lateral, turn, band);
  if (correlation.silent()) return {1};
  return taps_of_correlation(correlations(correlation, turn));
}

/// Taps at each range and angle of the grid.
std::vector<std::vector<double>> all_taps(const BeamGrid& grid, const ProbeOptics& optics) {
  const int angles = grid.angles();
  std::vector<std::vector<double>> taps(static_cast<std::size_t>(grid.ranges() * angles));
  const auto at_range = [&](int range) {
    const double range_m = grid.range_m(range);
    const ElevationRow elevation(optics, range_m);
    for (int angle = 0; angle < angles; ++angle) {
      const double theta_rad = grid.angle_rad(angle);
      taps[static_cast<std::size_t>(range * angles + angle)] =
          taps_at(optics.band(),
                  elevation,
                  lateral_row(StickAperture(optics, theta_rad), range_m),
                  turn_of_frames(optics, range_m, theta_rad));
    }
  };
  parallel_ranges(grid.ranges(), optics.threads(), [&](int first, int last) {
    for (int range = first; range < last; ++range) at_range(range);
  });
  return taps;
}

int longest(const std::vector<std::vector<double>>& taps) {
  std::size_t most = 1;
  for (const auto& row : taps) most = std::max(most, row.size());
  return static_cast<int>(most);
}

/// Standard deviation of the wavenumber over the band, each node weighted by `power_of(node)`.
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

/// Length of speckle relative to that of the pulse.
double length_ratio(const ProbeOptics& optics, double range_m) {
  const PulseBand& band = optics.band();
  const auto across = ElevationRow(optics, range_m).row.node_powers();
  const auto along = lateral_row(StickAperture(optics, 0), range_m).node_powers();
  const double sent = deviation_per_m(band, [](std::size_t) { return 1.0; });
  const double received =
      deviation_per_m(band, [&](std::size_t node) { return along[node] * across[node]; });
  return received > 0 ? sent / received : 1;
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

SpeckleKernels::SpeckleKernels(const ProbeOptics& optics)
    : grid_(optics.plan(), kKernelRangeStep_m, kAngleStep_rad),
      taps_(all_taps(grid_, optics)),
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

SpeckleLengths::SpeckleLengths(const ProbeOptics& optics) : step_m_(kLengthStep_m) {
  const double pulse_m = optics.band().sigma_m();
  const int count = static_cast<int>(std::ceil(optics.plan().acquisition().depth_m / step_m_)) + 1;
  sigmas_m_.resize(static_cast<std::size_t>(count));
  parallel_ranges(count, optics.threads(), [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      // At the face itself the beam is not defined.
      const double range_m = std::max(i, 1) * step_m_;
      sigmas_m_[static_cast<std::size_t>(i)] = pulse_m * length_ratio(optics, range_m);
    }
  });
}

double SpeckleLengths::sigma_m(double range_m) const {
  const double position =
      std::clamp(range_m / step_m_, 0.0, static_cast<double>(sigmas_m_.size() - 1));
  const auto first = std::min(static_cast<std::size_t>(position), sigmas_m_.size() - 1);
  const auto second = std::min(first + 1, sigmas_m_.size() - 1);
  return std::lerp(sigmas_m_[first], sigmas_m_[second], position - static_cast<double>(first));
}

}  // namespace wobblebench::sim
