// The synthetic probe: phantom in, image sticks out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hw/acquisition_plan.h"
#include "phantoms/phantom.h"
#include "sim/beam.h"
#include "sim/echo_field.h"
#include "sim/options.h"
#include "sim/tissue_sampler.h"

namespace wobblebench::sim {

/// The detected samples of one volume: [frame][line][sample], as the plan orders them.
using VolumeSamples = std::vector<float>;

/// Scans a still phantom. The phantom is sampled once, at construction; each volume then differs
/// only in its noise. Throws hw::InvalidOption.
class ProbeSimulator {
 public:
  ProbeSimulator(const phantoms::Phantom& phantom,
                 const phantoms::Placement& placement,
                 const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options);

  VolumeSamples volume(std::uint32_t index) const;

  const hw::AcquisitionPlan& plan() const { return plan_; }
  const SimulationOptions& options() const { return options_; }
  /// Which effects ran, in the order of the signal's way.
  std::vector<std::string> effects() const;

 private:
  void scan_field(const phantoms::Phantom& phantom, const phantoms::Placement& placement);
  void add_power(const TissueProfile& profile, float* power) const;
  void add_specular(const TissueProfile& profile, int frame, int line);
  void fill_echoes(const PowerField& power);
  void fill_even_speckle();
  double pulse_sigma_samples() const;
  void scan_geometry(const phantoms::Phantom& phantom, const phantoms::Placement& placement);

  hw::AcquisitionPlan plan_;
  SimulationOptions options_;
  std::vector<phantoms::Material> materials_;
  EchoField echoes_;           ///< rung `field`: noiseless IQ
  VolumeSamples mean_echoes_;  ///< rung `geometry`: final samples
};

}  // namespace wobblebench::sim
