// Vectorised kernels that turn scatterers into echoes and echoes into samples.
#pragma once

#include <cstdint>

#include "sim/beam/beam_table.h"
#include "sim/scatterers/projected_scatterers.h"

namespace wobblebench::sim {

/// A scatterer's contribution to the bin of its range, or a bin's sum of them: complex amplitudes
/// at the bin's near and far end (see sim/scatterers/range_bins.h).
struct alignas(16) BinShare {
  float low_re;
  float low_im;
  float high_re;
  float high_im;
};

struct EchoConstants {
  const BeamTable::Value* lateral;
  const BeamTable::Value* elevation;
  float cycles_per_m;  ///< of range: 2 f0 / c
  float bins_per_m;
  std::int32_t last_bin;  ///< collects echoes from beyond it, as bin 0 collects those from before
                          ///< range 0; neither is read
  float slope_per_bin;    ///< 1 / (2 k0 * bin)
};

/// Largest number of scatterers for one call of make_echoes().
inline constexpr int kEchoBatch = 256;

/// Computes the echoes of at most kEchoBatch scatterers: shares, and the bins that they belong to.
/// Bin 1 begins at range 0.
void make_echoes(const ProjectedScatterers& scatterers,
                 int count,
                 const EchoConstants& constants,
                 BinShare* shares,
                 std::int32_t* bins);

/// bins[at[i]] += shares[i], in this order.
void deposit(const BinShare* shares, const std::int32_t* at, int count, BinShare* bins);

/// Convolution: sums[m] += sum over t of taps[t] * values[m + t].
void convolve(const float* values, const float* taps, int tap_count, int count, float* sums);

}  // namespace wobblebench::sim
