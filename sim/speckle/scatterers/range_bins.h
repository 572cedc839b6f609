// Sums the echoes of many scatterers into one stick of IQ samples. Each echo is added to the bin of
// its range, at the nodes of the pulse's band; the pulse is convolved with the sums once, at the
// end.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/speckle/scatterers/echo_kernels.h"

namespace wobblebench::sim {

/// The pulses of the band's nodes, from the middle of a bin to samples, by levels of the centre's
/// frequency.
class PulseTaps {
 public:
  /// `spacing_m`: of the IQ samples, the first of which lies half a spacing from the face.
  PulseTaps(const PulseBand& band, double spacing_m);

  /// Steps of 1 % of the frequency sent: at the default bandwidth the pulse's phase differs by 0.1
  /// rad at most, at its ends.
  static constexpr int kLevels = 61;
  static double frequency_ratio(int level) { return 1 - 0.01 * level; }
  /// Clamped to the levels: BandLoss::kLowest is the last one.
  static int level(float frequency_ratio) {
    return std::clamp(static_cast<int>(std::lround((1 - frequency_ratio) * 100)), 0, kLevels - 1);
  }

  double spacing_m() const { return spacing_m_; }
  /// Half length of the pulse, in samples.
  int half_length() const { return half_length_; }
  int length() const { return 2 * half_length_ + 1; }
  int nodes() const { return nodes_; }
  /// [node][real, imaginary part][length()], for convolve_bins().
  const float* at(int level) const { return taps_[static_cast<std::size_t>(level)].data(); }

 private:
  double spacing_m_;
  int half_length_;
  int nodes_;
  std::vector<std::vector<float>> taps_;
};

/// What happens to echoes on the way, at each sample's range; constant beyond their last.
struct EchoLosses {
  std::span<const float> remaining;        ///< amplitude
  std::span<const float> frequency_ratio;  ///< of the pulse's centre; empty: 1
  std::span<const float> factor;           ///< on the amplitude besides; empty: 1
};

/// The bins of one stick; working memory of one thread.
class RangeBins {
 public:
  /// Clears the bins up to `end_m`; echoes from beyond are dropped.
  void begin(const PulseTaps& taps, double end_m);
  /// Adds echoes of at most kEchoBatch scatterers. `constants.last_bin` is last_bin().
  void add(const ProjectedScatterers& scatterers, int count, const EchoConstants& constants);
  /// Scales the sums, applies the pulse, and adds the result to `iq`.
  void finish(const PulseTaps& taps, const EchoLosses& losses, std::span<std::complex<float>> iq);

  std::int32_t last_bin() const { return last_bin_; }

 private:
  /// Sorts the scaled sums of `count` bins by node, with half a pulse of nothing on both sides.
  void sort(const PulseTaps& taps, int count, const EchoLosses& losses, std::size_t room);

  std::vector<BandValues> bins_;
  std::int32_t last_bin_ = 1;
  std::vector<float> sorted_;  ///< [node][real, imaginary part][bin]
};

}  // namespace wobblebench::sim
