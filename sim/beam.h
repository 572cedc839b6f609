// The beam's footprint: what scatters within its width echoes together. Sticks lie farther apart
// than the beam is wide, so the tissue is sampled on a finer grid and averaged under the beam.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/acquisition_plan.h"

namespace wobblebench::sim {

/// Mean echo power on a polar grid: frames x lines x samples, sample fastest.
struct PowerField {
  int frames = 0;
  int lines = 0;
  int samples = 0;
  std::vector<float> values;

  PowerField(int f, int l, int s)
      : frames(f), lines(l), samples(s), values(std::size_t(f) * std::size_t(l) * std::size_t(s)) {}
  float* stick(int frame, int line) {
    return values.data() + (static_cast<std::size_t>(frame) * lines + line) * samples;
  }
};

/// The sampling grid of the beam: each step between sticks, and between frames, is divided by these
/// so that the narrowest beam (at the elevation focus) is sampled twice a width. At most 4: a beam
/// much narrower than the sticks' distance sees only what is on its axis.
struct BeamGrid {
  int per_line = 1;
  int per_frame = 1;

  /// The sticks themselves.
  BeamGrid() = default;
  explicit BeamGrid(const hw::AcquisitionPlan& plan);
  int lines(const hw::AcquisitionPlan& plan) const;
  int frames(const hw::AcquisitionPlan& plan) const;
  /// Line of sight of a point of the grid, between sticks too.
  hw::Ray sightline(const hw::AcquisitionPlan& plan, int frame, int line) const;
};

/// Averages power along each stick under the pulse: a Gaussian of its amplitude's sigma over
/// sqrt 2.
void average_under_pulse(PowerField& field, double pulse_sigma_samples, int threads);
/// Largest weight of that average: a lone sample of power p shows as p times this.
double pulse_power_peak(double pulse_sigma_samples);

/// Averages power under the two-way beam (a Gaussian of the amplitude's width over sqrt 2) at each
/// range, first across lines, then across frames, and keeps the sticks of the plan. The skirt of
/// the beam below -20 dB is left out.
PowerField averaged_under_beam(PowerField fine,
                               const BeamGrid& grid,
                               const hw::AcquisitionPlan& plan,
                               double spacing_m,
                               int threads);

}  // namespace wobblebench::sim
