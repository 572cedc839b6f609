#include "sim/scatterers/range_bins.h"

#include <algorithm>
#include <cmath>

#include "hw/probe/acquisition_plan.h"
#include "sim/beam/point_spread.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

constexpr double kBinsPerSigma = 3.4;
constexpr double kPulseSigmas = 3.2;  // the pulse is 0.6 % of its peak there

/// Sums at one bin end of every sample: the far end of one bin and the near end of the next, scaled
/// by the remaining amplitude.
WOBBLEBENCH_SIMD void gather_phase(const BinShare* bins,
                                   int bins_per_sample,
                                   const float* __restrict remaining,
                                   const float* __restrict neighbour,
                                   float share,
                                   int samples,
                                   float* __restrict re,
                                   float* __restrict im) {
  for (int i = 0; i < samples; ++i) {
    const float amplitude = remaining[i] + share * (neighbour[i] - remaining[i]);
    const BinShare* first = bins + static_cast<std::ptrdiff_t>(i) * bins_per_sample;
    re[i] = amplitude * (first[0].high_re + first[1].low_re);
    im[i] = amplitude * (first[0].high_im + first[1].low_im);
  }
}

}  // namespace

PulseTaps::PulseTaps(const hw::AcquisitionPlan& plan, double spacing_m) : spacing_m_(spacing_m) {
  const double sigma_m = sigma_of_fwhm(axial_fwhm_m(plan));
  const int bins = std::max(1, static_cast<int>(std::ceil(kBinsPerSigma * spacing_m / sigma_m)));
  const double bin_m = spacing_m / bins;
  half_length_ = static_cast<int>(std::ceil(kPulseSigmas * sigma_m / spacing_m));
  // Linear interpolation widens the pulse: it adds a sixth of a squared bin to its variance, on
  // average.
  const double narrow_m = std::sqrt(sigma_m * sigma_m - bin_m * bin_m / 6);
  for (int end = 0; end < bins; ++end) {
    std::vector<float> taps;
    for (int t = -half_length_; t <= half_length_; ++t) {
      // From the middle of sample m to the bin end in sample m + t.
      const double offset_m = (t - 0.5) * spacing_m + end * bin_m;
      const double pulse = std::exp(-0.5 * offset_m * offset_m / (narrow_m * narrow_m));
      taps.push_back(static_cast<float>(sigma_m / narrow_m * pulse));
    }
    taps_.push_back(std::move(taps));
  }
}

void RangeBins::begin(const PulseTaps& taps, double end_m) {
  last_bin_ = static_cast<std::int32_t>(std::ceil(end_m / taps.bin_m())) + 1;
  bins_.assign(static_cast<std::size_t>(last_bin_) + 1, BinShare{0, 0, 0, 0});
}

void RangeBins::add(const BinShare* shares, const std::int32_t* at, int count) {
  deposit(shares, at, count, bins_.data());
}

void RangeBins::split_phases(const PulseTaps& taps, std::span<const float> remaining, int samples) {
  const int bins = taps.bins_per_sample();
  const int room = samples + 2 * taps.half_length() + 1;
  // Bin ends beyond the last sample contribute to it.
  const int columns = std::min((last_bin_ - 1) / bins, samples + taps.half_length());
  phases_.resize(static_cast<std::size_t>(bins));
  // Extended by one on either side with the outermost values.
  remaining_.assign(1, remaining.front());
  const auto covered = std::min(remaining.size(), static_cast<std::size_t>(columns) + 1);
  remaining_.insert(remaining_.end(),
                    remaining.begin(),
                    remaining.begin() + static_cast<std::ptrdiff_t>(covered));
  remaining_.resize(static_cast<std::size_t>(columns) + 2, remaining_.back());
  for (int end = 0; end < bins; ++end) {
    Phase& phase = phases_[static_cast<std::size_t>(end)];
    phase.re.assign(static_cast<std::size_t>(room), 0.0f);
    phase.im.assign(static_cast<std::size_t>(room), 0.0f);
    // Position between the middles of the sample and of its neighbour.
    const float between = static_cast<float>(end) / static_cast<float>(bins) - 0.5f;
    gather_phase(bins_.data() + end,
                 bins,
                 remaining_.data() + 1,
                 remaining_.data() + (between < 0 ? 0 : 2),
                 std::abs(between),
                 columns,
                 phase.re.data() + taps.half_length(),
                 phase.im.data() + taps.half_length());
  }
}

void RangeBins::finish(const PulseTaps& taps,
                       std::span<const float> remaining,
                       std::span<std::complex<float>> iq) {
  if (remaining.empty()) return;
  bins_.front() = {0, 0, 0, 0};  // echoes from before range 0
  const int samples = static_cast<int>(iq.size());
  split_phases(taps, remaining, samples);
  sum_re_.assign(iq.size(), 0.0f);
  sum_im_.assign(iq.size(), 0.0f);
  for (int end = 0; end < taps.bins_per_sample(); ++end) {
    const Phase& phase = phases_[static_cast<std::size_t>(end)];
    const std::vector<float>& pulse = taps.phase(end);
    const int count = static_cast<int>(pulse.size());
    convolve(phase.re.data(), pulse.data(), count, samples, sum_re_.data());
    convolve(phase.im.data(), pulse.data(), count, samples, sum_im_.data());
  }
  for (std::size_t i = 0; i < iq.size(); ++i) {
    iq[i] += std::complex<float>(sum_re_[i], sum_im_[i]);
  }
}

}  // namespace wobblebench::sim
