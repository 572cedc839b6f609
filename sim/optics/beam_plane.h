// The two directions across the beam, as functions of range: responses, and how far they reach.
#pragma once

#include <functional>
#include <vector>

#include "sim/optics/beam_row.h"
#include "sim/optics/frequency_course.h"

namespace wobblebench::sim {

/// Where a beam is taken to end.
struct BeamReach {
  double beyond = 0;       ///< share of its power that is left out
  FrequencyCourse course;  ///< of the pulses that it is to hold: lower ones have wider beams
};

/// One direction across one stick's beam.
class BeamPlane {
 public:
  /// In the image plane, for a stick at an angle; and across it. `plan` must outlive it. The others
  /// decide how far the beam reaches.
  static BeamPlane lateral(const hw::AcquisitionPlan& plan,
                           const PulseBand& band,
                           Apodisation apodisation,
                           double theta_rad,
                           const BeamReach& reach);
  static BeamPlane elevation(const hw::AcquisitionPlan& plan,
                             const PulseBand& band,
                             Apodisation apodisation,
                             const BeamReach& reach);

  /// Largest offset at a range: where the given share of the power lies beyond, but at least most
  /// of the focused beam's main lobe.
  double reach_m(double range_m) const;
  /// Reaches at evenly spaced ranges from `first_m` on, searched at a few of them.
  std::vector<double> reaches_m(double first_m, double step_m, int count) const;
  SampledRow sample(double range_m, double reach_m, int columns) const {
    return sample_row(response_(range_m), range_m, reach_m, both_sides_, columns);
  }
  PulseBand::Values on_axis(double range_m) const;

 private:
  using OfRange = std::function<double(double range_m)>;

  BeamPlane(const hw::AcquisitionPlan& plan,
            const PulseBand& band,
            const BeamReach& reach,
            bool both_sides);
  /// From the axis to the first zero of the focused beam.
  double lobe_m(double range_m) const {
    return wavelength_m_ / reach_.course.at(range_m) * range_m / aperture_m_(range_m);
  }

  std::function<PlaneResponse(double range_m)> response_;
  OfRange aperture_m_;  ///< on receive
  OfRange shadow_m_;    ///< width of the transmitted beam by geometry
  double wavelength_m_;
  PulseBand band_;
  BeamReach reach_;
  bool both_sides_;
};

}  // namespace wobblebench::sim
