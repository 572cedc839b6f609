// Sums the echoes of many scatterers into one stick of IQ samples. Each echo is added to the bin of
// its range, linearly interpolated between the bin's two ends; the pulse is convolved with the sums
// once, at the end (a polyphase filter). Bins are so short that linear interpolation of the pulse
// between their ends has an error below 0.5 % of its RMS.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/scatterers/echo_kernels.h"

namespace wobblebench::sim {

/// The pulse as a polyphase filter from bin ends to samples.
class PulseTaps {
 public:
  /// `spacing_m`: of the IQ samples, the first of which lies half a spacing from the face.
  PulseTaps(const hw::AcquisitionPlan& plan, double spacing_m);

  double spacing_m() const { return spacing_m_; }
  int bins_per_sample() const { return static_cast<int>(taps_.size()); }
  double bin_m() const { return spacing_m_ / bins_per_sample(); }
  /// Half length of the pulse, in samples.
  int half_length() const { return half_length_; }
  /// The taps for the `i`-th bin end of each sample, i below bins_per_sample().
  const std::vector<float>& phase(int i) const { return taps_[static_cast<std::size_t>(i)]; }

 private:
  double spacing_m_;
  int half_length_;
  std::vector<std::vector<float>> taps_;
};

/// The bins of one stick; working memory of one thread.
class RangeBins {
 public:
  /// Clears the bins up to `end_m`; echoes from beyond are dropped.
  void begin(const PulseTaps& taps, double end_m);
  /// Adds echoes to the given bins; bin 1 begins at range 0.
  void add(const BinShare* shares, const std::int32_t* at, int count);
  /// Scales the sums by the amplitude `remaining` at each sample's range (constant beyond the
  /// last), applies the pulse, and adds the result to `iq`.
  void finish(const PulseTaps& taps,
              std::span<const float> remaining,
              std::span<std::complex<float>> iq);

  std::int32_t last_bin() const { return last_bin_; }

 private:
  /// Sums at one bin end of every sample, padded by half a pulse on both sides.
  struct Phase {
    std::vector<float> re, im;
  };
  void split_phases(const PulseTaps& taps, std::span<const float> remaining, int samples);

  std::vector<BinShare> bins_;
  std::int32_t last_bin_ = 1;
  std::vector<Phase> phases_;
  std::vector<float> remaining_;  ///< at each sample, extended by one on either side
  std::vector<float> sum_re_, sum_im_;
};

}  // namespace wobblebench::sim
