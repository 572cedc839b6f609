// Complex baseband (IQ) echoes on the polar grid: homogeneous speckle with the probe's resolution,
// and the pulse of a single reflector. IQ rather than RF: a delay below one sample is a phase, and
// the sampling rate follows the bandwidth, not the centre frequency.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// frames x lines x samples, sample fastest. Sample i lies at range (i + 1/2) * spacing_m.
struct IqField {
  int frames = 0;
  int lines = 0;
  int samples = 0;
  double spacing_m = 0;
  std::vector<std::complex<float>> values;

  std::span<std::complex<float>> stick(int frame, int line) {
    return {values.data() + at(frame, line), static_cast<std::size_t>(samples)};
  }
  std::span<const std::complex<float>> stick(int frame, int line) const {
    return {values.data() + at(frame, line), static_cast<std::size_t>(samples)};
  }
  std::span<std::complex<float>> stick(const hw::StickIndex& index) {
    return stick(static_cast<int>(index.frame), static_cast<int>(index.line));
  }
  std::span<const std::complex<float>> stick(const hw::StickIndex& index) const {
    return stick(static_cast<int>(index.frame), static_cast<int>(index.line));
  }

 private:
  std::size_t at(int frame, int line) const {
    return (static_cast<std::size_t>(frame) * lines + line) * static_cast<std::size_t>(samples);
  }
};

/// Largest half length of a pulse, in IQ samples; reached only by scans finer than 1 um a sample.
inline constexpr int kMaxHalfPulse = 1024;

/// Memory of an IqField.
double iq_bytes(const hw::AcquisitionPlan& plan);

/// All samples 0.
IqField make_iq_field(const hw::AcquisitionPlan& plan);

/// Gaussian filters along a stick, one for each of its samples, of unit power.
class AxialKernels {
 public:
  explicit AxialKernels(const std::vector<double>& sigmas_samples);

  int samples() const { return samples_; }
  /// Taps lie at -half() to half() samples.
  int half() const { return half_; }
  /// Of each sample.
  const float* weights(int tap) const {
    return weights_.data() + static_cast<std::ptrdiff_t>(tap + half_) * samples_;
  }

 private:
  int samples_;
  int half_ = 0;
  std::vector<float> weights_;  ///< [tap][sample]
};

/// Circular complex white noise, filtered along the stick, of unit mean power. Throws
/// std::invalid_argument for a stick of another number of samples.
void fill_speckle(std::span<std::complex<float>> stick,
                  std::uint64_t key,
                  const AxialKernels& kernels);

/// Filters each range so that white noise gets the correlation of speckle there, across the lines
/// of each frame (sim/speckle/line_filter.h) or across frames (sim/speckle/speckle_kernels.h).
/// Keeps the mean power.
void filter_across_lines(IqField& field,
                         const hw::AcquisitionPlan& plan,
                         const SimulationOptions& options);
void filter_across_frames(IqField& field,
                          const hw::AcquisitionPlan& plan,
                          const SimulationOptions& options);

/// Speckle of unit mean power on the whole grid, filtered in all three directions.
IqField homogeneous_speckle(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

/// Adds the echo of one reflector: a Gaussian pulse of peak `amplitude` at a range, with the phase
/// of its two-way path.
void add_reflector(std::span<std::complex<float>> stick,
                   double spacing_m,
                   double range_m,
                   double amplitude,
                   const hw::AcquisitionPlan& plan);

}  // namespace wobblebench::sim
