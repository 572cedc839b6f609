#include "sim/speckle/scatterers/range_bins.h"

#include <algorithm>
#include <cmath>

#include "sim/losses/band_loss.h"

namespace wobblebench::sim {

namespace {

// Where the nodes' pulses are below 0.5 % of their peaks; below 7 % at the lowest frequency, whose
// spectrum is cut.
constexpr double kPulseSigmas = 5.5;
constexpr double kLastLevel = 100 * (1 - BandLoss::kLowest);
static_assert(kLastLevel > PulseTaps::kLevels - 1.5 && kLastLevel < PulseTaps::kLevels - 0.5);

}  // namespace

PulseTaps::PulseTaps(const PulseBand& band, double spacing_m)
    : spacing_m_(spacing_m),
      half_length_(static_cast<int>(std::ceil(kPulseSigmas * band.sigma_m() / spacing_m))),
      nodes_(band.nodes()) {
  for (int level = 0; level < kLevels; ++level) {
    auto& taps = taps_.emplace_back(static_cast<std::size_t>(2 * nodes_ * length()));
    for (int t = 0; t < length(); ++t) {
      // From the middle of bin m + t - half to sample m.
      const PulseBand::Values pulses =
          band.pulses((half_length_ - t) * spacing_m, frequency_ratio(level));
      for (int node = 0; node < nodes_; ++node) {
        const auto at = static_cast<std::size_t>(2 * node * length() + t);
        const std::complex<double>& pulse = pulses[static_cast<std::size_t>(node)];
        taps[at] = static_cast<float>(pulse.real());
        taps[at + static_cast<std::size_t>(length())] = static_cast<float>(pulse.imag());
      }
    }
  }
}

void RangeBins::begin(const PulseTaps& taps, double end_m) {
  last_bin_ = static_cast<std::int32_t>(std::ceil(end_m / taps.spacing_m())) + 1;
  bins_.assign(static_cast<std::size_t>(last_bin_) + 1, BandValues{});
}

void RangeBins::add(const ProjectedScatterers& scatterers,
                    int count,
                    const EchoConstants& constants) {
  add_echoes(scatterers, count, constants, bins_.data());
}

void RangeBins::sort(const PulseTaps& taps, int count, const EchoLosses& losses, std::size_t room) {
  sorted_.assign(2 * static_cast<std::size_t>(taps.nodes()) * room, 0.0f);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    float amplitude = losses.remaining[std::min(i, losses.remaining.size() - 1)];
    if (!losses.factor.empty()) amplitude *= losses.factor[std::min(i, losses.factor.size() - 1)];
    float* to = sorted_.data() + static_cast<std::size_t>(taps.half_length()) + i;
    const BandValues& bin = bins_[i + 1];
    for (int node = 0; node < taps.nodes(); ++node, to += 2 * room) {
      to[0] = amplitude * bin.re[node];
      to[room] = amplitude * bin.im[node];
    }
  }
}

void RangeBins::finish(const PulseTaps& taps,
                       const EchoLosses& losses,
                       std::span<std::complex<float>> iq) {
  if (losses.remaining.empty()) return;
  const int samples = static_cast<int>(iq.size()), half = taps.half_length();
  // Bins beyond the last sample contribute to it; the last bin is not read.
  const int count = std::min(last_bin_ - 1, samples + half);
  const std::size_t room = iq.size() + static_cast<std::size_t>(2 * half + kConvolved);
  sort(taps, count, losses, room);
  const std::span<const float> ratio = losses.frequency_ratio;
  const auto level_of = [&](int sample) {
    if (ratio.empty()) return 0;
    return PulseTaps::level(ratio[std::min(static_cast<std::size_t>(sample), ratio.size() - 1)]);
  };
  const BinSeries bins{sorted_.data(), room, taps.nodes(), taps.length()};
  for (int first = 0; first < samples;) {
    const int level = level_of(first);
    int end = first + 1;
    while (end < samples && end < first + kConvolved && level_of(end) == level) ++end;
    float re[kConvolved], im[kConvolved];
    convolve_bins(bins, taps.at(level), first, re, im);
    for (int i = first; i < end; ++i) {
      iq[static_cast<std::size_t>(i)] += std::complex<float>(re[i - first], im[i - first]);
    }
    first = end;
  }
}

}  // namespace wobblebench::sim
