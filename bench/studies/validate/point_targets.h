// The echo of one scatterer: how wide it is along the stick, across it, and across the image plane.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct PointInputs {
  /// Of the scatterer, along the axis from the face.
  std::vector<double> ranges_m = {50e-3, 75e-3, 110e-3};
  int across = 41;  ///< sticks of each profile
  /// Puts both fixed foci at the scatterer, where the formulas are exact closed forms.
  bool in_focus = true;
};

/// Amplitude across the beam (largest of each stick) or along it (each sample), normalised.
struct Profile {
  std::vector<double> offset_m;  ///< from the scatterer
  std::vector<double> amplitude;
  double fwhm_m = 0;
  double formula_m = 0;  ///< sim/beam/point_spread.h
};

struct PointResult {
  double range_m = 0;
  double amplitude = 0;  ///< of the stick through the scatterer; should be 1
  Profile axial;
  Profile lateral;
  Profile elevation;
};

/// One scatterer on the axis of the probe, scanned by sticks that rotate past it within the image
/// plane and across it. Rungs `scatterers` and `reference`.
PointResult measure_point(sim::Rung rung,
                          double range_m,
                          bool side_lobes,
                          const PointInputs& inputs);

}  // namespace wobblebench::bench
