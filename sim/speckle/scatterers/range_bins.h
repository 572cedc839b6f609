// Sums the echoes of many scatterers into one stick of IQ samples. Each echo is added to the bin of
// its range, at the nodes of the pulse's band; the sums are convolved with the pulse once, at the
// end.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/optics/pulse_band.h"
#include "sim/speckle/scatterers/stream_compaction.h"

namespace wobblebench::sim {

struct EchoConstants {
  const BandValues* lateral;  ///< the tables that ProjectedScatterers index
  const BandValues* elevation;
  float cycles_per_m;  ///< of range: 2 f0 / c
  float spacing_m;     ///< of the samples
  /// Phasors at the nodes, relative to an echo in the middle of the bin, for echoes at
  /// kBinPositions positions from the beginning of the bin on.
  const BandValues* bin_phasors;
  std::int32_t last_bin;  ///< collects the echoes beyond it; bin 0 collects those before range 0;
                          ///< neither is read
};

/// Positions distinguished in a bin: phase errors stay below 0.02 rad.
inline constexpr int kBinPositions = 64;

/// Largest number of scatterers for one call of RangeBins::add().
inline constexpr int kEchoBatch = 256;

/// The pulse of each node of the band, sampled from the middle of a bin, for discrete levels of the
/// centre frequency.
class PulseTaps {
 public:
  /// `spacing_m`: of the IQ samples, the first of which lies half a spacing from the face.
  PulseTaps(const PulseBand& band, double spacing_m);

  /// Steps of 1 % of the transmitted frequency: at the default bandwidth the phase changes by at
  /// most 0.1 rad per step, at the ends of the pulse.
  static constexpr int kLevels = 201;
  static double frequency_ratio(int level) { return 1 - 0.01 * level; }
  /// Nearest level; BandLoss::kLowest is the last one.
  static int level(float frequency_ratio) {
    return std::clamp(static_cast<int>(std::lround((1 - frequency_ratio) * 100)), 0, kLevels - 1);
  }

  double spacing_m() const { return spacing_m_; }
  /// Half length of the pulse, in samples.
  int half_length() const { return half_length_; }
  int length() const { return 2 * half_length_ + 1; }
  int nodes() const { return nodes_; }
  /// [node][real, imaginary part][length()].
  const float* at(int level) const { return taps_[static_cast<std::size_t>(level)].data(); }

 private:
  double spacing_m_;
  int half_length_;
  int nodes_;
  std::vector<std::vector<float>> taps_;
};

/// Losses of the echoes at each sample's range; the last values hold beyond.
struct EchoLosses {
  std::span<const float> remaining;        ///< amplitude
  std::span<const float> frequency_ratio;  ///< BandLoss::frequency_ratio(); empty: 1
};

/// The bins of one stick; working memory of one thread.
class RangeBins {
 public:
  /// Clears the bins up to `end_m`; echoes from beyond are dropped.
  void begin(const PulseTaps& taps, double end_m);
  /// Adds the echoes of at most kEchoBatch scatterers, in this order, to the bins of their ranges.
  /// A bin is one sample long; bin 1 begins at range 0. `constants.last_bin` is last_bin().
  void add(const ProjectedScatterers& scatterers, int count, const EchoConstants& constants);
  /// Scales the sums, applies the pulse, and adds the result to `iq`.
  void finish(const PulseTaps& taps, const EchoLosses& losses, std::span<std::complex<float>> iq);

  std::int32_t last_bin() const { return last_bin_; }

 private:
  /// Sorts the scaled sums of `count` bins by node, with half a pulse of zeros on both sides.
  void sort(const PulseTaps& taps, int count, const EchoLosses& losses, std::size_t room);

  std::vector<BandValues> bins_;
  std::int32_t last_bin_ = 1;
  std::vector<float> sorted_;  ///< [node][real, imaginary part][bin]
};

}  // namespace wobblebench::sim
