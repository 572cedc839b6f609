// How long speckle is along a stick.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// The pulse's length where all frequencies of the band are heard alike. Out of focus they are not:
/// of even tissue each frequency counts by the power that the middle stick's beam has at the range,
/// so that the band that is heard is narrower or wider than the one that was sent.
class SpeckleLengths {
 public:
  SpeckleLengths(const hw::AcquisitionPlan& plan, const SimulationOptions& options);

  /// Sigma of the echo amplitude's kernel over range; between tabulated ranges linear.
  double sigma_m(double range_m) const;

 private:
  double step_m_;
  std::vector<double> sigmas_m_;  ///< at multiples of step_m_, from the first on
};

}  // namespace wobblebench::sim
