#include "sim/scatterers/range_bins.h"

#include <algorithm>
#include <cmath>

#include "sim/beam/point_spread.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

constexpr double kBinsPerSigma = 3.4;
constexpr double kPulseSigmas = 3.2;  // the pulse has 0.6 % of its peak left

/// What bins give to the ends between them, one of each sample's. An end is the first bin's far end
/// and the second one's near end.
WOBBLEBENCH_SIMD void spread_place(const BinShare* bins,
                                   int bins_per_sample,
                                   const float* __restrict left,
                                   const float* __restrict neighbour,
                                   float share,
                                   int samples,
                                   float* __restrict re,
                                   float* __restrict im) {
  for (int i = 0; i < samples; ++i) {
    const float amplitude = left[i] + share * (neighbour[i] - left[i]);
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
  beside_ = static_cast<int>(std::ceil(kPulseSigmas * sigma_m / spacing_m));
  // Sharing between two ends widens the pulse, on average by a sixth of a bin squared.
  const double narrow_m = std::sqrt(sigma_m * sigma_m - bin_m * bin_m / 6);
  for (int place = 0; place < bins; ++place) {
    std::vector<float> taps;
    for (int t = -beside_; t <= beside_; ++t) {
      // An end in sample m + t, and the middle of sample m.
      const double away_m = (t - 0.5) * spacing_m + place * bin_m;
      const double pulse = std::exp(-0.5 * away_m * away_m / (narrow_m * narrow_m));
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

void RangeBins::spread(const PulseTaps& taps, std::span<const float> left, int samples) {
  const int bins = taps.bins_per_sample();
  const int room = samples + 2 * taps.beside() + 1;
  // Ends of bins beyond the last sample are heard in it.
  const int columns = std::min((last_bin_ - 1) / bins, samples + taps.beside());
  phases_.resize(static_cast<std::size_t>(bins));
  // One more on either side, like the last there.
  left_.assign(1, left.front());
  const auto heard = std::min(left.size(), static_cast<std::size_t>(columns) + 1);
  left_.insert(left_.end(), left.begin(), left.begin() + static_cast<std::ptrdiff_t>(heard));
  left_.resize(static_cast<std::size_t>(columns) + 2, left_.back());
  for (int place = 0; place < bins; ++place) {
    Phase& phase = phases_[static_cast<std::size_t>(place)];
    phase.re.assign(static_cast<std::size_t>(room), 0.0f);
    phase.im.assign(static_cast<std::size_t>(room), 0.0f);
    // Between the middles of the sample and of its neighbour.
    const float between = static_cast<float>(place) / static_cast<float>(bins) - 0.5f;
    spread_place(bins_.data() + place,
                 bins,
                 left_.data() + 1,
                 left_.data() + (between < 0 ? 0 : 2),
                 std::abs(between),
                 columns,
                 phase.re.data() + taps.beside(),
                 phase.im.data() + taps.beside());
  }
}

void RangeBins::finish(const PulseTaps& taps,
                       std::span<const float> left,
                       std::span<std::complex<float>> iq) {
  if (left.empty()) return;
  bins_.front() = {0, 0, 0, 0};  // what came from before the face
  const int samples = static_cast<int>(iq.size());
  spread(taps, left, samples);
  sum_re_.assign(iq.size(), 0.0f);
  sum_im_.assign(iq.size(), 0.0f);
  for (int place = 0; place < taps.bins_per_sample(); ++place) {
    const Phase& phase = phases_[static_cast<std::size_t>(place)];
    const std::vector<float>& pulse = taps.phase(place);
    const int count = static_cast<int>(pulse.size());
    smooth(phase.re.data(), pulse.data(), count, samples, sum_re_.data());
    smooth(phase.im.data(), pulse.data(), count, samples, sum_im_.data());
  }
  for (std::size_t i = 0; i < iq.size(); ++i) {
    iq[i] += std::complex<float>(sum_re_[i], sum_im_[i]);
  }
}

}  // namespace wobblebench::sim
