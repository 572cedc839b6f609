// The receive chain: noise, envelope, low-pass, decimation, time gain, log compression.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// [0, 1] over the dynamic range below full scale; amplitudes are against a perfect mirror.
float log_compressed(double amplitude, const SimulationOptions& options);

/// Detects sticks of IQ echoes. Not for several threads at once: it keeps its working memory.
class Receiver {
 public:
  /// `oversampling`: IQ samples for each output sample.
  Receiver(const hw::AcquisitionPlan& plan, const SimulationOptions& options, int oversampling);

  /// One stick: `iq` holds `oversampling` values for each of `samples`. `noise_key` makes this
  /// stick's noise its own.
  void detect(std::span<const std::complex<float>> iq,
              std::uint64_t noise_key,
              std::span<float> samples);

 private:
  void detect_block(
      const std::complex<float>* iq, std::uint64_t noise_key, int first, int count, float* samples);

  SimulationOptions options_;
  int oversampling_;
  float noise_;              ///< RMS amplitude
  std::vector<float> gain_;  ///< of each output sample, over full scale
  int first_noisy_ = 0;      ///< before this output sample no noise can show
  std::vector<float> envelope_;
};

}  // namespace wobblebench::sim
