// The synthetic probe: computes the sticks that a probe acquires from a phantom.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "sim/echo_store.h"
#include "sim/fidelity.h"
#include "sim/iq_sink.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// The detected samples of one volume, stick after stick in the order of their sequence numbers.
using VolumeSamples = std::vector<float>;

class TissueMap;

/// Returns the tissue map of a phantom, made or cached. The arguments are those of TissueMap's
/// constructor.
using TissueMapSource = std::function<std::shared_ptr<const TissueMap>(
    const phantoms::Phantom& phantom, double reach_m, int threads)>;

/// Scans a phantom. Where neither the phantom nor the directions of the sticks change from volume
/// to volume, echoes are computed once, by the constructor, and volumes differ in their noise only.
/// Copies share everything; const functions may be called from several threads.
///
/// @code
/// #include <iostream>
/// const auto phantom = phantoms::make_phantom({.name = "sphere"});
/// const auto placed = phantoms::still_at(phantom, phantom.suggested_position_m());
/// const hw::AcquisitionPlan plan({}, {.sticks_per_frame = 32, .frames_per_volume = 16});
/// const sim::ProbeSimulator simulator(placed, plan, {.noise_db = -80});
/// const sim::VolumeSamples samples = simulator.volume(0);
/// std::cout << samples.size() << " samples\n";  // 16 frames of 32 sticks of 512 samples
/// @endcode
class ProbeSimulator {
 public:
  /// Calls `maps` once for the phantom's map; without `maps` the constructor makes it. `echoes`
  /// keeps those of this subject, plan and options alone. Throws InvalidOption.
  ProbeSimulator(const phantoms::PlacedPhantom& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 const TissueMapSource& maps = {},
                 const EchoStore& echoes = {});

  /// `iq`, if given, takes the IQ samples that the volume is detected from; it is called on several
  /// threads at once, in no order, once for each stick. Throws std::logic_error if it is given on
  /// the rung geometry, which makes none.
  VolumeSamples volume(std::uint32_t index, const IqSink& iq = {}) const;
  /// A part of volume(), stick after stick as there: the frame whose first stick has the number
  /// `first_sequence`, and the frames fired after it, 16 in all or as many as the volume has left.
  /// They are computed together because neighbouring frames share tissue and tables of the beam.
  std::vector<float> block(std::uint64_t first_sequence) const;

  const hw::AcquisitionPlan& plan() const;
  const SimulationOptions& options() const;
  const Fidelity& fidelity() const;
  /// Names of the effects that ran, in the order of the signal path.
  std::vector<std::string> effects() const;

  /// Wall time of what is computed once for a phantom (its map), and once for a probe and seed
  /// (homogeneous speckle; echoes where they are the same in each volume).
  double map_ms() const;
  double once_ms() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace wobblebench::sim
