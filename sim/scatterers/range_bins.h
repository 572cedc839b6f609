// Echoes of many scatterers as one stick of IQ samples. Each scatterer goes into the bin of range
// that its echo falls into, shared between the bin's two ends; the pulse is put on once, at the
// end. Bins are so fine that a pulse between their ends is what lies on the straight line between
// pulses at both (error below 0.5 % of its RMS).
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/scatterers/echo_kernels.h"

namespace wobblebench::sim {

/// The pulse at the bins' ends around a sample.
class PulseTaps {
 public:
  /// `spacing_m`: of the IQ samples, the first of which lies half a spacing from the face.
  PulseTaps(const hw::AcquisitionPlan& plan, double spacing_m);

  double spacing_m() const { return spacing_m_; }
  int bins_per_sample() const { return static_cast<int>(taps_.size()); }
  double bin_m() const { return spacing_m_ / bins_per_sample(); }
  /// Samples that a pulse reaches to either side.
  int beside() const { return beside_; }
  /// For each place of a bin's end between two samples: the pulse at the samples around.
  const std::vector<float>& phase(int place) const {
    return taps_[static_cast<std::size_t>(place)];
  }

 private:
  double spacing_m_;
  int beside_;
  std::vector<std::vector<float>> taps_;
};

/// The bins of one stick; working memory of one thread.
class RangeBins {
 public:
  /// Clears bins up to `end_m`; echoes from beyond are lost.
  void begin(const PulseTaps& taps, double end_m);
  /// Adds echoes to the bins that they name; bin 1 begins at range 0.
  void add(const BinShare* shares, const std::int32_t* at, int count);
  /// Puts on the pulse and what is `left` of each echo's amplitude at its range (at the ranges of
  /// the samples; what lies beyond the last has as much left as the last), and adds the echoes to
  /// `iq`.
  void finish(const PulseTaps& taps,
              std::span<const float> left,
              std::span<std::complex<float>> iq);

  std::int32_t last_bin() const { return last_bin_; }

 private:
  /// Sums at the bins' ends that have one place between two samples, with room on both sides.
  struct Phase {
    std::vector<float> re, im;
  };
  void spread(const PulseTaps& taps, std::span<const float> left, int samples);

  std::vector<BinShare> bins_;
  std::int32_t last_bin_ = 1;
  std::vector<Phase> phases_;
  std::vector<float> left_;  ///< of each sample, and one more on either side
  std::vector<float> sum_re_, sum_im_;
};

}  // namespace wobblebench::sim
