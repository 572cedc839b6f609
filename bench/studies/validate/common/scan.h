// What the studies scan: phantoms that scenes cannot name, plans of the presets, and one simulated
// volume with its plan.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/probe.h"
#include "phantoms/phantom.h"
#include "phantoms/placed_phantom.h"
#include "sim/probe_simulator.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::bench {

/// One material everywhere.
phantoms::Phantom open_tissue(const std::string& material = "soft_tissue");

/// A block of tissue in fluid; `half_m`: half its size, about the phantom's origin.
phantoms::Phantom block(const glm::dvec3& half_m, double voxel_m);

/// A phantom at its own origin, as the models of sim take it, on `threads` threads.
sim::ScannedTissue scanned(const phantoms::Phantom& phantom, int threads);

/// A preset's sector with `beyond` more lines on either side at the same spacing, so that sticks
/// can turn past a point on the last one. The array ends where it does.
/// `acquisition.sticks_per_frame` counts the lines of the sector itself; its sector is ignored.
hw::AcquisitionPlan preset_plan(hw::ProbePreset preset,
                                hw::AcquisitionOptions acquisition,
                                int beyond);

/// First of `samples` samples at or beyond a range.
int first_sample_at(double range_m, double spacing_m, int samples);

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
