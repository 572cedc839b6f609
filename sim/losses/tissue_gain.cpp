#include "sim/losses/tissue_gain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/math/fast_math.h"
#include "sim/optics/beam_row.h"

namespace wobblebench::sim {

namespace {

constexpr double kRangeStep_m = 2.5e-3;
constexpr int kColumns = 64;  ///< a side
constexpr int kStride = 16;   ///< samples between two looked-up gains

/// Frequency ratios from 1 to BandLoss::kLowest.
constexpr int kRatios = 41;
constexpr double kRatioStep = (1 - BandLoss::kLowest) / (kRatios - 1);

using Powers = std::array<double, PulseBand::kNodes>;

/// Half width of a row that contains the beam at the lowest node, too.
double reach_m(double lobe_m, double aperture_m, double range_m, double focus_m) {
  return 2 * lobe_m + 0.5 * aperture_m * std::abs(1 - range_m / focus_m);
}

/// Two-way power at each node of the band, summed over the middle stick's cross-section.
Powers beam_powers(const ProbeOptics& optics, double range_m) {
  const auto& probe = optics.probe();
  const double longest_m = 2 * kPi / optics.band().wavenumber_per_m(0);
  const double sent_m = optics.transmit_aperture_m(range_m);
  const double received_m = optics.receive_aperture_m(range_m);
  const double lateral_m = std::min(
      2 * longest_m * range_m / received_m,
      reach_m(longest_m * range_m / sent_m, sent_m, range_m, optics.transmit_focus_m(range_m)));
  const double height_m = probe.element_height_m;
  const double elevation_m =
      reach_m(longest_m * range_m / height_m, height_m, range_m, probe.elevation_focus_m);
  const StickAperture aperture(optics, 0);
  const auto in_plane =
      sample_row(PlaneResponse::lateral(aperture, range_m), range_m, lateral_m, true, kColumns);
  const auto across =
      sample_row(PlaneResponse::elevation(optics, range_m), range_m, elevation_m, false, kColumns);
  Powers powers = in_plane.node_powers();
  const Powers factors = across.node_powers();
  for (std::size_t node = 0; node < powers.size(); ++node) powers[node] *= factors[node];
  return powers;
}

/// Linear between the nodes in the logarithms of power and frequency, and beyond the outermost.
class PowerOfFrequency {
 public:
  PowerOfFrequency(const PulseBand& band, const Powers& powers) {
    for (std::size_t node = 0; node < powers.size(); ++node) {
      const double per_m = band.wavenumber_per_m(static_cast<int>(node));
      log_frequency_[node] = std::log(per_m / band.center_per_m());
      log_power_[node] = std::log(powers[node]);
    }
  }
  double log_at(double frequency) const {
    const double x = std::log(frequency);
    std::size_t behind = 1;
    while (behind + 1 < log_frequency_.size() && log_frequency_[behind] < x) ++behind;
    const double step = log_frequency_[behind] - log_frequency_[behind - 1];
    return std::lerp(
        log_power_[behind - 1], log_power_[behind], (x - log_frequency_[behind - 1]) / step);
  }

 private:
  Powers log_frequency_, log_power_;
};

/// Multiplies values that lie kStride apart, and between them linearly.
WOBBLEBENCH_SIMD void scale_between(
    const float* __restrict from, float gain, float next, int count, float* __restrict to) {
  const float rise = (next - gain) / kStride;
  for (int i = 0; i < count; ++i) to[i] = from[i] * (gain + rise * static_cast<float>(i));
}

}  // namespace

TissueGain::TissueGain(const ProbeOptics& optics, double spacing_m, int samples)
    : ranges_(optics.plan(), kRangeStep_m, kPi) {
  gain_.resize(static_cast<std::size_t>(ranges_.ranges() * kRatios));
  parallel_ranges(ranges_.ranges(), optics.threads(), [&](int first, int last) {
    for (int range = first; range < last; ++range) tabulate(optics, range);
  });
  for (int i = 0; i < samples + kStride; i += kStride) {
    at_samples_.push_back(ranges_.range_at((i + 0.5) * spacing_m));
  }
}

void TissueGain::tabulate(const ProbeOptics& optics, int range) {
  constexpr double kStep = 0.01;  // of frequencies, relative to the centre's
  constexpr double kSigmas = 4;
  const BandLoss band(optics.probe());
  const PowerOfFrequency power(optics.band(), beam_powers(optics, ranges_.range_m(range)));
  const double sigma = std::sqrt(band.variance());
  std::array<double, kRatios> left = {};
  const double end = 1 + kSigmas * sigma;
  for (int step = 0; BandLoss::kBandEnd + (step + 0.5) * kStep < end; ++step) {
    const double f = BandLoss::kBandEnd + (step + 0.5) * kStep;
    const double away = (f - 1) / sigma;
    const double share = std::exp(power.log_at(f) - away * away);
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double nepers = static_cast<double>(i) * kRatioStep / band.variance();
      left[i] += share * std::exp(-2 * nepers * (f - 1));
    }
  }
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double nepers = static_cast<double>(i) * kRatioStep / band.variance();
    const double log_gain = 0.5 * std::log(left[i] / left[0]) - band.log_gain(nepers);
    gain_[static_cast<std::size_t>(range * kRatios) + i] = static_cast<float>(std::exp(log_gain));
  }
}

float TissueGain::interpolate(const BeamGrid::Between& range, float frequency_ratio) const {
  constexpr auto kPerRatio = static_cast<float>(1 / kRatioStep);
  const float at = std::clamp((1 - frequency_ratio) * kPerRatio, 0.0f, kRatios - 1.0f);
  const auto before = std::min(static_cast<std::size_t>(at), std::size_t{kRatios - 2});
  const float share = at - static_cast<float>(before);
  const auto of_range = [&](std::size_t row) {
    const float* gains = gain_.data() + row * kRatios + before;
    return gains[0] + share * (gains[1] - gains[0]);
  };
  const float first = of_range(range.first);
  return first + static_cast<float>(range.share) * (of_range(range.second) - first);
}

void TissueGain::apply(const StickLosses& losses, std::vector<float>& remaining) const {
  const std::vector<float>& mirror = losses.remaining();
  const std::vector<float>& ratio = losses.frequency_ratio();
  if (ratio.empty()) {
    remaining.assign(mirror.begin(), mirror.end());
    return;
  }
  const std::size_t count = mirror.size();
  remaining.resize(count);
  const auto gain_at = [&](std::size_t sample) {
    return interpolate(at_samples_[sample / kStride], ratio[std::min(sample, count - 1)]);
  };
  float gain = count > 0 ? gain_at(0) : 1;
  for (std::size_t first = 0; first < count; first += kStride) {
    const float next = gain_at(first + kStride);
    const auto samples = static_cast<int>(std::min<std::size_t>(kStride, count - first));
    scale_between(mirror.data() + first, gain, next, samples, remaining.data() + first);
    gain = next;
  }
}

}  // namespace wobblebench::sim
