// The rung `scatterers` against `reference`: the same scatterers, two methods of summing their
// echoes.
#pragma once

#include <cstdint>
#include <vector>

#include "base/units.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// A tile of tissue on the axis, wider than the main lobe, scanned by a narrow sector.
struct AgreementInputs {
  std::vector<double> ranges_m = {50e-3, 75e-3, 110e-3};  ///< of its middle, from the face
  double thickness_m = 2e-3;
  double half_width_m = 9e-3;
  int sticks = 10;
  double sector_rad = 7 * kDegree;
  std::uint64_t seed = 1;
};

struct AgreementResult {
  double range_m = 0;
  /// Correlation of the envelope with that of `reference`.
  double main_lobe = 0;
  double side_lobes = 0;
  /// RMS of the envelope over that of `reference`.
  double main_lobe_db = 0;
  double side_lobes_db = 0;
  long n = 0;  ///< samples
};
AgreementResult measure_agreement(double range_m, const AgreementInputs& inputs);

}  // namespace wobblebench::bench
