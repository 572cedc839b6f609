// Vectorised kernels that turn scatterers into echoes and echoes into samples.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/optics/pulse_band.h"
#include "sim/speckle/scatterers/projected_scatterers.h"

namespace wobblebench::sim {

struct EchoConstants {
  const BandValues* lateral;  ///< the tables that ProjectedScatterers index
  const BandValues* elevation;
  float cycles_per_m;  ///< of range: 2 f0 / c
  float spacing_m;     ///< of the samples
  /// Phasors at the nodes by which a scatterer's echo differs from one in the middle of its bin, at
  /// kBinPlaces places from the bin's beginning on.
  const BandValues* places;
  std::int32_t last_bin;  ///< collects echoes from beyond it, as bin 0 collects those from before
                          ///< range 0; neither is read
};

/// Places told apart in a bin: errors of phase stay below 0.02 rad.
inline constexpr int kBinPlaces = 64;

/// Largest number of scatterers for one call of add_echoes().
inline constexpr int kEchoBatch = 256;

/// Adds the echoes of at most kEchoBatch scatterers, in this order, to the bins of their ranges, at
/// the nodes of the pulse's band. A bin is one sample long, bin 1 begins at range 0.
void add_echoes(const ProjectedScatterers& scatterers,
                int count,
                const EchoConstants& constants,
                BandValues* bins);

/// Sums of bins by node: [node][real, imaginary part][room].
struct BinSeries {
  const float* values;
  std::size_t room;
  int nodes;
  int tap_count;
};

/// Samples that convolve_bins() makes at a time.
inline constexpr int kConvolved = 16;

/// sample[m] = sum over nodes and t of taps[node][t] * values[node][first + m + t], complex.
/// `taps`: [node][real, imaginary part][tap_count].
void convolve_bins(const BinSeries& bins, const float* taps, int first, float* re, float* im);

}  // namespace wobblebench::sim
