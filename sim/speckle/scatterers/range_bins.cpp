#include "sim/speckle/scatterers/range_bins.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/losses/losses.h"
#include "sim/math/fast_math.h"

namespace wobblebench::sim {

namespace {

/// The values at all nodes, as one AVX register.
using Nodes = float __attribute__((vector_size(32)));
static_assert(sizeof(Nodes) == sizeof(BandValues::re));

/// A batch of echoes: complex amplitude, with the phase of the range, and range bin.
struct EchoLanes {
  float re[kEchoBatch];
  float im[kEchoBatch];
  std::int32_t bin[kEchoBatch];
  std::int32_t position[kEchoBatch];  ///< in the bin
};

WOBBLEBENCH_SIMD void locate_echoes(const ProjectedScatterers& scatterers,
                                    int count,
                                    const EchoConstants& constants,
                                    EchoLanes& __restrict lanes) {
  const float* ranges = scatterers.range_m;
  const float* amplitudes = scatterers.amplitude;
  const float positions_per_m = static_cast<float>(kBinPositions) / constants.spacing_m;
  const float cycles_per_m = constants.cycles_per_m;
  const std::int32_t last_bin = constants.last_bin;
  for (int i = 0; i < count; ++i) {
    const float range = ranges[i], amplitude = amplitudes[i];
    const std::int32_t position =
        static_cast<std::int32_t>(range * positions_per_m + static_cast<float>(kBinPositions));
    const std::int32_t positive = position < 0 ? 0 : position;
    const std::int32_t bin = positive / kBinPositions;
    const CosSin at = cos_sin_of_cycles(-range * cycles_per_m);
    lanes.re[i] = amplitude * at.cosine;
    lanes.im[i] = amplitude * at.sine;
    lanes.bin[i] = bin > last_bin ? last_bin : bin;
    lanes.position[i] = positive % kBinPositions;
  }
}

/// By reference: the default clone has no register to return it in.
WOBBLEBENCH_INLINE const Nodes& nodes(const float* values) {
  return *reinterpret_cast<const Nodes*>(values);
}

/// bin += lateral * elevation * phasor * (re + i im).
WOBBLEBENCH_INLINE void add_echo(const BandValues& lateral,
                                 const BandValues& elevation,
                                 const BandValues& phasor,
                                 float re,
                                 float im,
                                 BandValues& bin) {
  const Nodes &phasor_re = nodes(phasor.re), &phasor_im = nodes(phasor.im);
  const Nodes phase_re = re * phasor_re - im * phasor_im;
  const Nodes phase_im = re * phasor_im + im * phasor_re;
  const Nodes &lateral_re = nodes(lateral.re), &lateral_im = nodes(lateral.im);
  const Nodes &elevation_re = nodes(elevation.re), &elevation_im = nodes(elevation.im);
  const Nodes beam_re = lateral_re * elevation_re - lateral_im * elevation_im;
  const Nodes beam_im = lateral_re * elevation_im + lateral_im * elevation_re;
  *reinterpret_cast<Nodes*>(bin.re) += beam_re * phase_re - beam_im * phase_im;
  *reinterpret_cast<Nodes*>(bin.im) += beam_re * phase_im + beam_im * phase_re;
}

WOBBLEBENCH_SIMD void sum_echoes(const EchoLanes& lanes,
                                 const std::uint32_t* table_index,
                                 int count,
                                 const EchoConstants& constants,
                                 BandValues* bins) {
  const BandValues* lateral = constants.lateral;
  const BandValues* elevation = constants.elevation;
  const BandValues* phasors = constants.bin_phasors;
  constexpr int kAhead = 24;
  for (int i = 0; i < count; ++i) {
    // Neither table fits the first-level cache.
    const std::uint32_t ahead = table_index[std::min(i + kAhead, count - 1)];
    __builtin_prefetch(lateral + (ahead & 0xffffu));
    __builtin_prefetch(elevation + (ahead >> 16));
    add_echo(lateral[table_index[i] & 0xffffu],
             elevation[table_index[i] >> 16],
             phasors[lanes.position[i]],
             lanes.re[i],
             lanes.im[i],
             bins[lanes.bin[i]]);
  }
}

/// Sums of bins by node: [node][real, imaginary part][room].
struct BinSeries {
  const float* values;
  std::size_t room;
  int nodes;
  int tap_count;
};

/// Samples that convolve_bins() computes at a time.
constexpr int kConvolved = 16;

/// sample[m] = sum over nodes and t of taps[node][t] * values[node][first + m + t], complex.
/// `taps`: [node][real, imaginary part][tap_count].
WOBBLEBENCH_SIMD void convolve_bins(const BinSeries& bins,
                                    const float* taps,
                                    int first,
                                    float* __restrict re,
                                    float* __restrict im) {
  float sum_re[kConvolved] = {}, sum_im[kConvolved] = {};
  const auto length = static_cast<std::size_t>(bins.tap_count);
  for (int node = 0; node < bins.nodes; ++node) {
    const auto series = 2 * static_cast<std::size_t>(node);
    const float* from_re = bins.values + series * bins.room + first;
    const float* from_im = from_re + bins.room;
    const float* taps_re = taps + series * length;
    for (std::size_t t = 0; t < length; ++t) {
      const float tap_re = taps_re[t], tap_im = taps_re[length + t];
      for (std::size_t m = 0; m < kConvolved; ++m) {
        sum_re[m] += tap_re * from_re[t + m] - tap_im * from_im[t + m];
        sum_im[m] += tap_re * from_im[t + m] + tap_im * from_re[t + m];
      }
    }
  }
  for (int m = 0; m < kConvolved; ++m) {
    re[m] = sum_re[m];
    im[m] = sum_im[m];
  }
}

/// The nodes' pulses are below 0.5 % of their peaks there.
constexpr double kPulseSigmas = 5.5;
/// Of a spectrum that ends with a step, absorption leaves little but the step: with 5.5 deep tissue
/// would lose 0.7 dB.
constexpr double kStepSigmas = 14;
constexpr double kLastLevel = 100 * (1 - BandLoss::kLowest);
static_assert(kLastLevel > PulseTaps::kLevels - 1.5 && kLastLevel < PulseTaps::kLevels - 0.5);

}  // namespace

PulseTaps::PulseTaps(const PulseBand& band, double spacing_m)
    : spacing_m_(spacing_m),
      half_length_(static_cast<int>(std::ceil((band.ends_with_step() ? kStepSigmas : kPulseSigmas) *
                                              band.sigma_m() / spacing_m))),
      nodes_(band.nodes()) {
  for (int level = 0; level < kLevels; ++level) {
    auto& taps = taps_.emplace_back(static_cast<std::size_t>(2 * nodes_ * length()));
    double energy = 0;
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
      energy += std::norm(std::accumulate(pulses.begin(), pulses.end(), std::complex<double>()));
    }
    // Tissue keeps its mean power without the ends of the pulse.
    const double whole = band.length_m(frequency_ratio(level)) / spacing_m;
    for (float& tap : taps) tap *= static_cast<float>(std::sqrt(whole / energy));
  }
}

void RangeBins::begin(const PulseTaps& taps, double end_m) {
  last_bin_ = static_cast<std::int32_t>(std::ceil(end_m / taps.spacing_m())) + 1;
  bins_.assign(static_cast<std::size_t>(last_bin_) + 1, BandValues{});
}

void RangeBins::add(const ProjectedScatterers& scatterers,
                    int count,
                    const EchoConstants& constants) {
  EchoLanes lanes;
  locate_echoes(scatterers, count, constants, lanes);
  sum_echoes(lanes, scatterers.table_index, count, constants, bins_.data());
}

void RangeBins::sort(const PulseTaps& taps, int count, const EchoLosses& losses, std::size_t room) {
  sorted_.assign(2 * static_cast<std::size_t>(taps.nodes()) * room, 0.0f);
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const float amplitude = losses.remaining[std::min(i, losses.remaining.size() - 1)];
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
