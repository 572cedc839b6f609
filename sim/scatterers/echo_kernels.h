// Echoes of the scatterers that a stick sees, in loops that compilers make wide.
#pragma once

#include <cstdint>

#include "sim/beam/beam_table.h"
#include "sim/math/stream_compaction.h"

namespace wobblebench::sim {

/// What a scatterer puts into the bin that its echo falls into; see sim/scatterers/range_bins.h.
struct alignas(16) BinShare {
  float low_re;
  float low_im;
  float high_re;
  float high_im;
};

struct EchoConstants {
  const BeamTable::Value* lateral;
  const BeamTable::Value* elevation;
  float cycles_per_m;  ///< of path: 2 f0 / c
  float bins_per_m;
  std::int32_t last_bin;  ///< what lies beyond it, and what lies before range 0, falls into the
                          ///< last and the first bin, which nobody reads
  float colour_per_bin;   ///< 1 / (2 k0 * bin)
};

/// Echoes are made at most this many at a time.
inline constexpr int kEchoBatch = 256;

/// The echoes of at most kEchoBatch scatterers: shares and the bins that they belong to; bin 1
/// begins at range 0.
void make_echoes(const SeenScatterers& seen,
                 int count,
                 const EchoConstants& constants,
                 BinShare* shares,
                 std::int32_t* bins);

/// bins[at[i]] += shares[i], in this order.
void deposit(const BinShare* shares, const std::int32_t* at, int count, BinShare* bins);

/// sums[m] += sum over taps of taps[t] * values[m + t].
void smooth(const float* values, const float* taps, int tap_count, int count, float* sums);

}  // namespace wobblebench::sim
