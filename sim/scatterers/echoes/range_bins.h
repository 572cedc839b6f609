// Sums the echoes of many scatterers into one stick of IQ samples. Each echo is added to the bin of
// its range, at the nodes of the pulse's band; the pulse is convolved with the sums once, at the
// end.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/scatterers/echoes/echo_kernels.h"

namespace wobblebench::sim {

/// The pulses of the band's nodes, from the middle of a bin to samples.
class PulseTaps {
 public:
  /// `spacing_m`: of the IQ samples, the first of which lies half a spacing from the face.
  PulseTaps(const PulseBand& band, double spacing_m);

  double spacing_m() const { return spacing_m_; }
  /// Half length of the pulse, in samples.
  int half_length() const { return half_length_; }

  /// Nodes of a narrow band come in pairs about its centre, whose pulses are conjugates: those of
  /// the higher one.
  static constexpr int kAlone = -1;
  struct Pair {
    int low;  ///< kAlone: there is none
    int high;
    std::vector<float> re, im;
  };
  const std::vector<Pair>& pairs() const { return pairs_; }
  /// Of nodes.
  int groups() const { return groups_; }

 private:
  double spacing_m_;
  int half_length_;
  int groups_;
  std::vector<Pair> pairs_;
};

/// The bins of one stick; working memory of one thread.
class RangeBins {
 public:
  /// Clears the bins up to `end_m`; echoes from beyond are dropped.
  void begin(const PulseTaps& taps, double end_m);
  /// Adds echoes of at most kEchoBatch scatterers. `constants.last_bin` is last_bin().
  void add(const ProjectedScatterers& scatterers, int count, const EchoConstants& constants);
  /// Scales the sums by the amplitude `remaining` at each sample's range and by `factor` (constant
  /// beyond their last; an empty factor is 1), applies the pulse, and adds the result to `iq`.
  void finish(const PulseTaps& taps,
              std::span<const float> remaining,
              std::span<const float> factor,
              std::span<std::complex<float>> iq);

  std::int32_t last_bin() const { return last_bin_; }

 private:
  /// Sums of a pair of nodes, or differences, at each bin, padded by half a pulse on both sides.
  struct Parts {
    std::vector<float> sum_re, sum_im, difference_re, difference_im;
  };
  void split_pair(const PulseTaps& taps, const PulseTaps::Pair& pair, int count, std::size_t room);
  void scale(const PulseTaps& taps,
             int count,
             std::span<const float> remaining,
             std::span<const float> factor);

  std::vector<BandValues> bins_;  ///< [bin][group]
  std::int32_t last_bin_ = 1;
  Parts parts_;
  std::vector<float> sum_re_, sum_im_;
};

}  // namespace wobblebench::sim
