// The synthetic probe: phantom in, image sticks out.
#pragma once

#include <complex>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "sim/echo/iq_field.h"
#include "sim/fidelity.h"
#include "sim/options.h"
#include "sim/receive/receiver.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

class StickEchoes;

/// The detected samples of one volume, stick after stick in the order of their sequence numbers.
using VolumeSamples = std::vector<float>;

/// Scans a phantom. Where neither the phantom nor the places of the sticks change from volume to
/// volume, echoes are made once, at construction, and volumes differ in their noise alone.
class ProbeSimulator {
 public:
  /// Throws InvalidOption.
  ProbeSimulator(const phantoms::PlacedPhantom& subject,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options);

  VolumeSamples volume(std::uint32_t index) const;

  const hw::AcquisitionPlan& plan() const { return plan_; }
  const SimulationOptions& options() const { return options_; }
  const Fidelity& fidelity() const { return fidelity_; }
  /// Names of the effects that ran, in the order of the signal's way.
  std::vector<std::string> effects() const;

  /// Wall time of what is done once for a phantom (its map), and once for a probe and seed (even
  /// speckle; echoes where they stay the same).
  double map_ms() const { return map_ms_; }
  double once_ms() const { return once_ms_; }

 private:
  VolumeSamples geometry_volume(std::uint32_t index) const;
  void prepare_echoes();

  hw::AcquisitionPlan plan_;
  SimulationOptions options_;
  Fidelity fidelity_;
  ScannedTissue subject_;
  std::shared_ptr<const StickEchoes> source_;
  std::optional<Receiver> fresh_receiver_;  ///< what a thread begins with: gains over the range
  IqField echoes_;  ///< noiseless IQ of every stick, where it is the same in each volume
  bool same_in_each_volume_ = false;
  double map_ms_ = 0;
  double once_ms_ = 0;
};

}  // namespace wobblebench::sim
