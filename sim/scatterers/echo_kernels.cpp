#include "sim/scatterers/echo_kernels.h"

#include "sim/math/fast_math.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

/// The values at the four nodes of the band, as one SIMD register.
using Nodes = float __attribute__((vector_size(16)));
static_assert(sizeof(Nodes) == sizeof(BandValues::re));

/// Phases of a batch: of the range, and by which the band's nodes differ from it.
struct PhaseLanes {
  CosSin range[kEchoBatch];
  CosSin inner[kEchoBatch];
  CosSin outer[kEchoBatch];
};

WOBBLEBENCH_SIMD void compute_phases(const ProjectedScatterers& scatterers,
                                     int count,
                                     const EchoConstants& constants,
                                     PhaseLanes& __restrict phases,
                                     std::int32_t* __restrict bins) {
  const float* ranges = scatterers.range_m;
  const float* amplitudes = scatterers.amplitude;
  const float spacing = constants.spacing_m, per_m = 1.0f / spacing;
  const float cycles_per_m = constants.cycles_per_m;
  const float inner_per_m = constants.inner_per_m, outer_per_m = constants.outer_per_m;
  const std::int32_t last_bin = constants.last_bin;
  for (int i = 0; i < count; ++i) {
    const float range = ranges[i], amplitude = amplitudes[i];
    const float position = range * per_m + 1.0f;
    const std::int32_t whole = static_cast<std::int32_t>(position);
    const std::int32_t positive = whole < 0 ? 0 : whole;
    const std::int32_t bin = positive > last_bin ? last_bin : positive;
    const float from_middle = (position - (static_cast<float>(bin) + 0.5f)) * spacing;
    const CosSin at = cos_sin_of_cycles(-range * cycles_per_m);
    phases.range[i] = {amplitude * at.cosine, amplitude * at.sine};
    phases.inner[i] = cos_sin_of_cycles(from_middle * inner_per_m);
    phases.outer[i] = cos_sin_of_cycles(from_middle * outer_per_m);
    bins[i] = bin;
  }
}

WOBBLEBENCH_INLINE Nodes load(const float* values) {
  return *reinterpret_cast<const Nodes*>(values);
}

/// bin += lateral * elevation * the scatterer's phases. Nodes ascend, so that the first two have
/// the opposite phase of the last two.
WOBBLEBENCH_INLINE void add_echo(const BandValues& lateral,
                                 const BandValues& elevation,
                                 const CosSin& range,
                                 const CosSin& inner,
                                 const CosSin& outer,
                                 BandValues& bin) {
  const Nodes cosine = {outer.cosine, inner.cosine, inner.cosine, outer.cosine};
  const Nodes sine = {outer.sine, inner.sine, -inner.sine, -outer.sine};
  const Nodes phase_re = range.cosine * cosine - range.sine * sine;
  const Nodes phase_im = range.cosine * sine + range.sine * cosine;
  const Nodes lateral_re = load(lateral.re), lateral_im = load(lateral.im);
  const Nodes elevation_re = load(elevation.re), elevation_im = load(elevation.im);
  const Nodes beam_re = lateral_re * elevation_re - lateral_im * elevation_im;
  const Nodes beam_im = lateral_re * elevation_im + lateral_im * elevation_re;
  *reinterpret_cast<Nodes*>(bin.re) += beam_re * phase_re - beam_im * phase_im;
  *reinterpret_cast<Nodes*>(bin.im) += beam_re * phase_im + beam_im * phase_re;
}

}  // namespace

void add_echoes(const ProjectedScatterers& scatterers,
                int count,
                const EchoConstants& constants,
                BandValues* bins) {
  PhaseLanes phases;
  std::int32_t at[kEchoBatch];
  compute_phases(scatterers, count, constants, phases, at);
  for (int i = 0; i < count; ++i) {
    const std::uint32_t index = scatterers.table_index[i];
    add_echo(constants.lateral[index & 0xffffu],
             constants.elevation[index >> 16],
             phases.range[i],
             phases.inner[i],
             phases.outer[i],
             bins[at[i]]);
  }
}

WOBBLEBENCH_SIMD void convolve(
    const float* values, const float* taps, int tap_count, int count, float* __restrict sums) {
  for (int t = 0; t < tap_count; ++t) {
    const float tap = taps[t];
    const float* from = values + t;
    for (int m = 0; m < count; ++m) sums[m] += tap * from[m];
  }
}

}  // namespace wobblebench::sim
