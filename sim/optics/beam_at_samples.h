// The beam's width and level at each sample of a stick.
#pragma once

#include <vector>

#include "sim/optics/beam_profile.h"

namespace wobblebench::sim {

/// Sigma of the power of a Gaussian amplitude response of this full width at half maximum.
double power_sigma(double amplitude_fwhm);

struct BeamAtSample {
  float lateral2 = 0;  ///< squared sigma of the two-way power
  float elevation2 = 0;
  float level2 = 1;  ///< echo power of even tissue over that of the middle stick
};

/// Tables for sticks at closely spaced angles; sample i lies at range (i + 1/2) * spacing_m.
class BeamAtSamples {
 public:
  BeamAtSamples(const hw::AcquisitionPlan& plan,
                const BeamProfile& profile,
                double spacing_m,
                int samples);

  int samples() const { return samples_; }
  /// The samples of a stick.
  const BeamAtSample* of(double theta_rad) const;

 private:
  int samples_;
  double angle_step_rad_;
  int angles_;
  std::vector<BeamAtSample> table_;  ///< [angle][sample]
};

}  // namespace wobblebench::sim
