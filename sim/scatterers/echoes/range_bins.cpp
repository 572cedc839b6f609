#include "sim/scatterers/echoes/range_bins.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::sim {

namespace {

constexpr double kPulseSigmas = 4;  // where the band's pulses are below 0.5 % of their peaks

}  // namespace

PulseTaps::PulseTaps(const PulseBand& band, double spacing_m)
    : spacing_m_(spacing_m),
      half_length_(static_cast<int>(std::ceil(kPulseSigmas * band.sigma_m() / spacing_m))) {
  constexpr int kLast = PulseBand::kNodes - 1;
  for (int low = 0; 2 * low < kLast; ++low) {
    Pair pair{low, kLast - low, {}, {}};
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
  bins_.assign(static_cast<std::size_t>(last_bin_) + 1, BandValues{});
}

void RangeBins::add(const ProjectedScatterers& scatterers,
                    int count,
                    const EchoConstants& constants) {
  add_echoes(scatterers, count, constants, bins_.data());
}

void RangeBins::split_pair(const PulseTaps::Pair& pair, int first, int count, std::size_t room) {
  for (auto* values :
       {&parts_.sum_re, &parts_.sum_im, &parts_.difference_re, &parts_.difference_im}) {
    values->assign(room, 0.0f);
  }
  for (int i = 0; i < count; ++i) {
    const BandValues& bin = bins_[static_cast<std::size_t>(i) + 1];
    const auto at = static_cast<std::size_t>(first + i);
    parts_.sum_re[at] = bin.re[pair.high] + bin.re[pair.low];
    parts_.sum_im[at] = bin.im[pair.high] + bin.im[pair.low];
    parts_.difference_re[at] = bin.re[pair.high] - bin.re[pair.low];
    parts_.difference_im[at] = bin.im[pair.low] - bin.im[pair.high];  // i times i
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
  for (int i = 0; i < count; ++i) {
    BandValues& bin = bins_[static_cast<std::size_t>(i) + 1];
    const auto at = static_cast<std::size_t>(i);
    float amplitude = remaining[std::min(at, remaining.size() - 1)];
    if (!factor.empty()) amplitude *= factor[std::min(at, factor.size() - 1)];
    for (float& value : bin.re) value *= amplitude;
    for (float& value : bin.im) value *= amplitude;
  }
  sum_re_.assign(iq.size(), 0.0f);
  sum_im_.assign(iq.size(), 0.0f);
  const int tap_count = 2 * half + 1;
  for (const PulseTaps::Pair& pair : taps.pairs()) {
    split_pair(pair, half, count, iq.size() + static_cast<std::size_t>(2 * half));
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
