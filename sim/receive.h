// The receive chain: noise, envelope, time gain, low-pass, decimation, log compression.
#pragma once

#include <complex>
#include <cstdint>
#include <span>

#include "hw/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// [0, 1] over the dynamic range below full scale; amplitudes are against a perfect mirror.
float log_compressed(double amplitude, const SimulationOptions& options);

/// Detects one stick of IQ echoes into `samples.size()` output samples; `iq` holds a whole multiple
/// of them. `noise_key` makes this stick's noise its own.
void receive(std::span<const std::complex<float>> iq,
             std::uint64_t noise_key,
             const hw::AcquisitionPlan& plan,
             const SimulationOptions& options,
             std::span<float> samples);

}  // namespace wobblebench::sim
