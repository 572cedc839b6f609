// Complex baseband (IQ) echoes on the polar grid: homogeneous speckle with the probe's resolution,
// and the pulse of a single reflector. IQ rather than RF: a delay below one sample is a phase, and
// the sampling rate follows the bandwidth, not the centre frequency.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/optics/probe_optics.h"

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

/// Largest half length of a pulse, in IQ samples; only scans finer than 1 um per sample reach it.
inline constexpr int kMaxHalfPulse = 1024;

/// Bytes of an IqField.
double iq_bytes(const hw::AcquisitionPlan& plan);

/// A field for the plan's sticks at the IQ rate; all samples are 0.
IqField make_iq_field(const hw::AcquisitionPlan& plan);

/// Taps of a Gaussian filter with sum of squares 1, so that filtered white noise keeps its power.
/// Their number is odd, at most 2 * max_half + 1; taps below one percent of the peak are left out.
std::vector<float> unit_power_gaussian(double sigma_in_steps, int max_half);

/// Gaussian filters along a stick, one for each of its samples, of unit power.
class AxialKernels {
 public:
  explicit AxialKernels(const std::vector<double>& sigmas_samples);

  int samples() const { return samples_; }
  /// Taps lie at -half() to half() samples.
  int half() const { return half_; }
  /// Weight of one tap for each sample.
  const float* weights(int tap) const {
    return weights_.data() + static_cast<std::ptrdiff_t>(tap + half_) * samples_;
  }

 private:
  int samples_;
  int half_ = 0;
  std::vector<float> weights_;  ///< [tap][sample]
};

/// Circular complex white noise, filtered along the stick, of unit mean power. Throws
/// std::invalid_argument if the stick and the kernels have different numbers of samples.
void fill_speckle(std::span<std::complex<float>> stick,
                  std::uint64_t key,
                  const AxialKernels& kernels);

/// Filter each range so that white noise gets the correlation that speckle has there, across the
/// lines of each frame (by the factor of their LineCovariance) or across frames (SpeckleKernels).
/// The mean power is unchanged.
void filter_across_lines(IqField& field, const ProbeOptics& optics);
void filter_across_frames(IqField& field, const ProbeOptics& optics);

/// Speckle of unit mean power on the whole grid, filtered in all three directions.
IqField homogeneous_speckle(const ProbeOptics& optics, std::uint64_t seed);

/// Adds the echo of one reflector: a Gaussian pulse of peak `amplitude` at a range, with the phase
/// of its two-way path.
void add_reflector(std::span<std::complex<float>> stick,
                   double spacing_m,
                   double range_m,
                   double amplitude,
                   const hw::AcquisitionPlan& plan);

}  // namespace wobblebench::sim
