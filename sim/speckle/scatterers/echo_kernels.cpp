#include "sim/speckle/scatterers/echo_kernels.h"

#include <algorithm>

#include "sim/math/fast_math.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

/// The values at all nodes, as one AVX register.
using Nodes = float __attribute__((vector_size(32)));
static_assert(sizeof(Nodes) == sizeof(BandValues::re));

/// Amplitudes with the phase of the range, and bins, of a batch.
struct EchoLanes {
  float re[kEchoBatch];
  float im[kEchoBatch];
  std::int32_t bin[kEchoBatch];
  std::int32_t place[kEchoBatch];  ///< in the bin
};

WOBBLEBENCH_SIMD void locate_echoes(const ProjectedScatterers& scatterers,
                                    int count,
                                    const EchoConstants& constants,
                                    EchoLanes& __restrict lanes) {
  const float* ranges = scatterers.range_m;
  const float* amplitudes = scatterers.amplitude;
  const float places_per_m = static_cast<float>(kBinPlaces) / constants.spacing_m;
  const float cycles_per_m = constants.cycles_per_m;
  const std::int32_t last_bin = constants.last_bin;
  for (int i = 0; i < count; ++i) {
    const float range = ranges[i], amplitude = amplitudes[i];
    const std::int32_t place =
        static_cast<std::int32_t>(range * places_per_m + static_cast<float>(kBinPlaces));
    const std::int32_t positive = place < 0 ? 0 : place;
    const std::int32_t bin = positive / kBinPlaces;
    const CosSin at = cos_sin_of_cycles(-range * cycles_per_m);
    lanes.re[i] = amplitude * at.cosine;
    lanes.im[i] = amplitude * at.sine;
    lanes.bin[i] = bin > last_bin ? last_bin : bin;
    lanes.place[i] = positive % kBinPlaces;
  }
}

/// By reference: the default clone has no register to return it in.
WOBBLEBENCH_INLINE const Nodes& nodes(const float* values) {
  return *reinterpret_cast<const Nodes*>(values);
}

/// bin += lateral * elevation * place * (re + i im).
WOBBLEBENCH_INLINE void add_echo(const BandValues& lateral,
                                 const BandValues& elevation,
                                 const BandValues& place,
                                 float re,
                                 float im,
                                 BandValues& bin) {
  const Nodes &place_re = nodes(place.re), &place_im = nodes(place.im);
  const Nodes phase_re = re * place_re - im * place_im;
  const Nodes phase_im = re * place_im + im * place_re;
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
  const BandValues* places = constants.places;
  constexpr int kAhead = 24;
  for (int i = 0; i < count; ++i) {
    // Neither table fits the first-level cache.
    const std::uint32_t ahead = table_index[std::min(i + kAhead, count - 1)];
    __builtin_prefetch(lateral + (ahead & 0xffffu));
    __builtin_prefetch(elevation + (ahead >> 16));
    add_echo(lateral[table_index[i] & 0xffffu],
             elevation[table_index[i] >> 16],
             places[lanes.place[i]],
             lanes.re[i],
             lanes.im[i],
             bins[lanes.bin[i]]);
  }
}

}  // namespace

void add_echoes(const ProjectedScatterers& scatterers,
                int count,
                const EchoConstants& constants,
                BandValues* bins) {
  EchoLanes lanes;
  locate_echoes(scatterers, count, constants, lanes);
  sum_echoes(lanes, scatterers.table_index, count, constants, bins);
}

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

}  // namespace wobblebench::sim
