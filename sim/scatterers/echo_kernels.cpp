#include "sim/scatterers/echo_kernels.h"

#include <cstring>

#include "sim/math/fast_math.h"
#include "sim/math/simd.h"

namespace wobblebench::sim {

namespace {

/// std::complex's product checks for infinities, which prevents vectorisation.
struct Complex {
  float re;
  float im;
};

WOBBLEBENCH_INLINE Complex operator*(const Complex& a, const Complex& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

/// Echoes as a structure of arrays.
struct EchoLanes {
  float low_re[kEchoBatch];
  float low_im[kEchoBatch];
  float high_re[kEchoBatch];
  float high_im[kEchoBatch];
};

/// The beam table's entries of each scatterer, gathered by whole entries: look-ups within the loop
/// would prevent vectorisation.
struct BeamLanes {
  BeamTable::Value lateral[kEchoBatch];
  BeamTable::Value elevation[kEchoBatch];
};

void look_up(const EchoConstants& constants,
             const std::uint32_t* table_index,
             int count,
             BeamLanes& to) {
  for (int i = 0; i < count; ++i) {
    const BeamTable::Value* lateral = constants.lateral + (table_index[i] & 0xffffu);
    const BeamTable::Value* elevation = constants.elevation + (table_index[i] >> 16);
    std::memcpy(to.lateral + i, lateral, sizeof *lateral);
    std::memcpy(to.elevation + i, elevation, sizeof *elevation);
  }
}

WOBBLEBENCH_INLINE void echo_lanes(const ProjectedScatterers& scatterers,
                                   const BeamLanes& beam,
                                   int count,
                                   const EchoConstants& constants,
                                   EchoLanes& __restrict lanes,
                                   std::int32_t* __restrict bins) {
  const BeamTable::Value* lateral = beam.lateral;
  const BeamTable::Value* elevation = beam.elevation;
  const float* ranges = scatterers.range_m;
  const float* amplitudes = scatterers.amplitude;
  const float cycles_per_m = constants.cycles_per_m, bins_per_m = constants.bins_per_m;
  const float slope_per_bin = constants.slope_per_bin;
  const std::int32_t last_bin = constants.last_bin;
  for (int i = 0; i < count; ++i) {
    const float range = ranges[i];
    const float amplitude = amplitudes[i] * (lateral[i].amplitude * elevation[i].amplitude);
    const float cycles = lateral[i].cycles + elevation[i].cycles - range * cycles_per_m;
    const CosSin angle = cos_sin_of_cycles(cycles);
    const Complex echo{amplitude * angle.cosine, amplitude * angle.sine};
    const Complex slope{lateral[i].slope_re + elevation[i].slope_re,
                        lateral[i].slope_im + elevation[i].slope_im};
    const Complex sloped = slope * echo;
    const float position = range * bins_per_m + 1.0f;
    const std::int32_t whole = static_cast<std::int32_t>(position);
    const std::int32_t positive = whole < 0 ? 0 : whole;
    const std::int32_t bin = positive > last_bin ? last_bin : positive;
    const float high = position - static_cast<float>(bin);
    // The term of the pulse's derivative, p' B / (2 i k0), as the difference of the bin's two ends.
    const Complex derivative{slope_per_bin * sloped.im, -slope_per_bin * sloped.re};
    const Complex far{high * echo.re - derivative.re, high * echo.im - derivative.im};
    lanes.low_re[i] = echo.re - far.re;
    lanes.low_im[i] = echo.im - far.im;
    lanes.high_re[i] = far.re;
    lanes.high_im[i] = far.im;
    bins[i] = bin;
  }
}

WOBBLEBENCH_SIMD void shape_echoes(const ProjectedScatterers& scatterers,
                                   const BeamLanes& beam,
                                   int count,
                                   const EchoConstants& constants,
                                   BinShare* __restrict shares,
                                   std::int32_t* __restrict bins) {
  EchoLanes lanes;
  echo_lanes(scatterers, beam, count, constants, lanes, bins);
  for (int i = 0; i < count; ++i) {
    shares[i] = {lanes.low_re[i], lanes.low_im[i], lanes.high_re[i], lanes.high_im[i]};
  }
}

}  // namespace

void make_echoes(const ProjectedScatterers& scatterers,
                 int count,
                 const EchoConstants& constants,
                 BinShare* shares,
                 std::int32_t* bins) {
  BeamLanes beam;
  look_up(constants, scatterers.table_index, count, beam);
  shape_echoes(scatterers, beam, count, constants, shares, bins);
}

void deposit(const BinShare* shares, const std::int32_t* at, int count, BinShare* bins) {
  for (int i = 0; i < count; ++i) {
    BinShare& bin = bins[at[i]];
    bin.low_re += shares[i].low_re;
    bin.low_im += shares[i].low_im;
    bin.high_re += shares[i].high_re;
    bin.high_im += shares[i].high_im;
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
