// One simulated volume with its plan.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// The samples of one volume, and the plan that they were acquired with.
struct Scan {
  hw::AcquisitionPlan plan;
  sim::VolumeSamples samples;

  double at(int frame, int line, int sample) const {
    const auto& a = plan.acquisition();
    return static_cast<double>(samples[static_cast<std::size_t>(
        (frame * a.sticks_per_frame + line) * a.samples_per_stick + sample)]);
  }
  std::vector<double> stick(int frame, int line) const;
  /// First sample at or beyond a range.
  int sample_at(double range_m) const;
};

/// Linear envelope relative to a perfect mirror, without noise, time gain and the receiver's
/// low-pass.
sim::SimulationOptions bare_envelope(sim::Rung rung, std::uint64_t seed);
/// The same without attenuation, transmission loss and interface echoes: mean amplitudes do not
/// depend on range.
sim::SimulationOptions lossless_envelope(sim::Rung rung, std::uint64_t seed);

Scan scan(const phantoms::PlacedPhantom& subject,
          const hw::AcquisitionPlan& plan,
          const sim::SimulationOptions& options,
          std::uint32_t volume = 0);

}  // namespace wobblebench::bench
