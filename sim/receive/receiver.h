// The receive chain: electronic noise, envelope detection, low-pass, decimation, time-gain
// compensation (TGC), log compression.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// TGC at a range, as an amplitude factor.
double time_gain(const hw::AcquisitionPlan& plan, const SimulationOptions& options, double range_m);

/// Upper bound of the electronic noise's amplitude before TGC, 0 without noise.
double largest_noise(const hw::AcquisitionPlan& plan,
                     const SimulationOptions& options,
                     int oversampling);

/// Amplitude at the face below which an echo is invisible: 20 dB below the noise, or without noise
/// below the dynamic range. 0: every echo is visible.
double visible_amplitude(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

/// Log compression of an amplitude (1: a perfect mirror) to [0, 1]: the dynamic range below full
/// scale. 0 for NaN.
float log_compressed(double amplitude, const SimulationOptions& options);

/// Detects sticks of IQ echoes. Holds the working memory of one thread.
class Receiver {
 public:
  /// `oversampling`: IQ samples per output sample.
  Receiver(const hw::AcquisitionPlan& plan, const SimulationOptions& options, int oversampling);

  /// Detects one stick: `iq` holds `oversampling` values per element of `samples`. Noise is a
  /// function of `noise_key` (sim/math/random.h) and the IQ sample; it has the pulse's band, to
  /// which a receiver is matched. Every sample is finite: gain is limited to 600 dB.
  void detect(std::span<const std::complex<float>> iq,
              std::uint64_t noise_key,
              std::span<float> samples);

  /// Adds the stick's noise: `noisy` becomes the IQ samples whose envelope detect() computes.
  void add_noise(std::span<const std::complex<float>> iq,
                 std::uint64_t noise_key,
                 std::vector<std::complex<float>>& noisy);

 private:
  /// The noise of `count` IQ samples from `first` on; valid until the next call.
  const float* noise(std::uint64_t key, int first, int count);
  void detect_block(
      const std::complex<float>* iq, std::uint64_t noise_key, int first, int count, float* samples);

  SimulationOptions options_;
  int oversampling_;
  std::vector<float> noise_filter_;  ///< of white noise of unit power; empty: no noise
  std::vector<float> gain_;          ///< TGC of each output sample, over full scale
  int first_noisy_ = 0;  ///< first output sample whose noise can exceed the dynamic range's floor
  std::vector<float> white_noise_;
  std::vector<float> noise_;
  std::vector<float> envelope_;
};

}  // namespace wobblebench::sim
