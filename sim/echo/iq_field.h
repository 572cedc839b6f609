// Complex baseband (IQ) echoes on the polar grid: even speckle with the probe's resolution, and the
// pulse of a single reflector. IQ, not RF: sub-sample delay is a phase, and the rate follows the
// bandwidth.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// frames x lines x samples, sample fastest. A sample's middle lies at (i + 1/2) * spacing_m.
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

 private:
  std::size_t at(int frame, int line) const {
    return (static_cast<std::size_t>(frame) * lines + line) * static_cast<std::size_t>(samples);
  }
};

/// Longest half of a pulse, in IQ samples; reached only by scans finer than a micrometre a sample.
inline constexpr int kMaxHalfPulse = 1024;

/// IQ samples for each output sample, so that the two-sided band of the pulse fits the rate.
int iq_oversampling(const hw::AcquisitionPlan& plan);

IqField make_iq_field(const hw::AcquisitionPlan& plan);

/// White circular noise of unit power, filtered by the pulse to unit power again.
void fill_speckle(std::span<std::complex<float>> stick,
                  std::uint64_t key,
                  double pulse_sigma_samples);

/// Filters each range across the lines of a frame, then across frames, by the beam's width there,
/// keeping the power.
void filter_across_lines(IqField& field, const hw::AcquisitionPlan& plan, int threads);
void filter_across_frames(IqField& field, const hw::AcquisitionPlan& plan, int threads);

/// Speckle of unit power on the whole grid, filtered in all three directions.
IqField homogeneous_speckle(const hw::AcquisitionPlan& plan, std::uint64_t seed, int threads);

/// Adds the echo of a single reflector: a pulse of peak `amplitude` at a range, with its phase.
void add_reflector(std::span<std::complex<float>> stick,
                   double spacing_m,
                   double range_m,
                   double amplitude,
                   const hw::AcquisitionPlan& plan);

}  // namespace wobblebench::sim
