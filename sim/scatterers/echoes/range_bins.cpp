#include "sim/scatterers/echoes/range_bins.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

// Where the nodes' pulses are below 0.5 % of their peaks.
constexpr double kPulseSigmas = 5.5;

}  // namespace

PulseTaps::PulseTaps(const PulseBand& band, double spacing_m)
    : spacing_m_(spacing_m),
      half_length_(static_cast<int>(std::ceil(kPulseSigmas * band.sigma_m() / spacing_m))),
      groups_(band.groups()) {
  const int last = band.nodes() - 1;
  for (int high = band.symmetric() ? band.nodes() / 2 : 0; high <= last; ++high) {
    Pair pair{band.symmetric() ? last - high : kAlone, high, {}, {}};
    for (int t = -half_length_; t <= half_length_; ++t) {
      // From the middle of bin m + t to sample m.
      const std::complex<double> pulse = band.pulse(pair.high, -t * spacing_m);
      pair.re.push_back(static_cast<float>(pulse.real()));
      pair.im.push_back(static_cast<float>(pulse.imag()));
    }
    pairs_.push_back(std::move(pair));
  }
}

void RangeBins::begin(const PulseTaps& taps, double end_m) {
  last_bin_ = static_cast<std::int32_t>(std::ceil(end_m / taps.spacing_m())) + 1;
  const auto count = static_cast<std::size_t>(last_bin_) + 1;
  bins_.assign(count * static_cast<std::size_t>(taps.groups()), BandValues{});
}

void RangeBins::add(const ProjectedScatterers& scatterers,
                    int count,
                    const EchoConstants& constants) {
  add_echoes(scatterers, count, constants, bins_.data());
}

void RangeBins::split_pair(const PulseTaps& taps,
                           const PulseTaps::Pair& pair,
                           int count,
                           std::size_t room) {
  for (auto* values :
       {&parts_.sum_re, &parts_.sum_im, &parts_.difference_re, &parts_.difference_im}) {
    values->assign(room, 0.0f);
  }
  const auto group_of = [&](int node) {
    return bins_.data() + taps.groups() + node / BandValues::kNodes;
  };
  const bool alone = pair.low == PulseTaps::kAlone;
  const BandValues *highs = group_of(pair.high), *lows = group_of(alone ? pair.high : pair.low);
  const int high = pair.high % BandValues::kNodes;
  const int low = alone ? high : pair.low % BandValues::kNodes;
  const float low_counts = alone ? 0.0f : 1.0f;
  for (int i = 0; i < count; ++i) {
    const std::ptrdiff_t bin = std::ptrdiff_t{i} * taps.groups();
    const float re = highs[bin].re[high], im = highs[bin].im[high];
    const float low_re = low_counts * lows[bin].re[low], low_im = low_counts * lows[bin].im[low];
    const auto at = static_cast<std::size_t>(taps.half_length() + i);
    parts_.sum_re[at] = re + low_re;
    parts_.sum_im[at] = im + low_im;
    parts_.difference_re[at] = re - low_re;
    parts_.difference_im[at] = low_im - im;  // i times i
  }
}

void RangeBins::scale(const PulseTaps& taps,
                      int count,
                      std::span<const float> remaining,
                      std::span<const float> factor) {
  const auto groups = static_cast<std::size_t>(taps.groups());
  for (std::size_t at = 0; at < static_cast<std::size_t>(count); ++at) {
    float amplitude = remaining[std::min(at, remaining.size() - 1)];
    if (!factor.empty()) amplitude *= factor[std::min(at, factor.size() - 1)];
    for (std::size_t g = 0; g < groups; ++g) {
      BandValues& bin = bins_[(at + 1) * groups + g];
      for (float& value : bin.re) value *= amplitude;
      for (float& value : bin.im) value *= amplitude;
    }
  }
}

void RangeBins::finish(const PulseTaps& taps,
                       std::span<const float> remaining,
                       std::span<const float> factor,
                       std::span<std::complex<float>> iq) {
  if (remaining.empty()) return;
  const int samples = static_cast<int>(iq.size()), half = taps.half_length();
  // Bins beyond the last sample contribute to it; the last bin is not read.
  const int count = std::min(last_bin_ - 1, samples + half);
  scale(taps, count, remaining, factor);
  sum_re_.assign(iq.size(), 0.0f);
  sum_im_.assign(iq.size(), 0.0f);
  const int tap_count = 2 * half + 1;
  for (const PulseTaps::Pair& pair : taps.pairs()) {
    split_pair(taps, pair, count, iq.size() + static_cast<std::size_t>(2 * half));
    convolve(parts_.sum_re.data(), pair.re.data(), tap_count, samples, sum_re_.data());
    convolve(parts_.sum_im.data(), pair.re.data(), tap_count, samples, sum_im_.data());
    convolve(parts_.difference_im.data(), pair.im.data(), tap_count, samples, sum_re_.data());
    convolve(parts_.difference_re.data(), pair.im.data(), tap_count, samples, sum_im_.data());
  }
  for (std::size_t i = 0; i < iq.size(); ++i) {
    iq[i] += std::complex<float>(sum_re_[i], sum_im_[i]);
  }
}

}  // namespace wobblebench::sim
