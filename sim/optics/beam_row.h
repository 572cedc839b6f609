// One row of the beam's table, as sampled from the response.
#pragma once

#include <functional>
#include <vector>

#include "sim/optics/plane_response.h"

namespace wobblebench::sim {

/// Responses at evenly spaced offsets, from -reach to reach or from 0 to reach.
struct SampledRow {
  double reach_m = 0;
  bool both_sides = false;
  std::vector<PulseBand::Values> values;

  double step_m() const {
    return (both_sides ? 2 : 1) * reach_m / static_cast<double>(values.size());
  }
  double offset_m(std::size_t column) const {
    return (static_cast<double>(column) + 0.5) * step_m() - (both_sides ? reach_m : 0);
  }
};

/// The response over a row whose middle is at `range_m`, in `columns` a side.
SampledRow sample_row(
    const PlaneResponse& response, double range_m, double reach_m, bool both_sides, int columns);

/// The offset beyond which, on both sides together, the share `beyond` of the row's power lies, for
/// a pulse whose centre is at `frequency_ratio` of the one sent.
double power_reach_m(const SampledRow& row,
                     const PulseBand& band,
                     double frequency_ratio,
                     double beyond);

/// The delay that varies as a parabola over the row.
struct RowDelay {
  double delay_m = 0;
  double tilt = 0;
  double curvature_per_m = 0;

  double at(double offset_m) const {
    return delay_m + (tilt + curvature_per_m * offset_m) * offset_m;
  }
};

/// Least-squares parabola through the group delays, weighted by power.
RowDelay fit_delay(const SampledRow& row, const PulseBand& band);

/// A row's responses without a delay, times `scale`.
std::vector<PulseBand::Values> aligned(const SampledRow& row,
                                       const RowDelay& delay,
                                       const PulseBand& band,
                                       double scale);

}  // namespace wobblebench::sim
