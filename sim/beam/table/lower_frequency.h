// The beam of a pulse whose frequency has fallen, from the table of the frequency that was sent.
//
// Out of its focus an aperture of width a adds the phase k a^2 (1 / focus - 1 / range) / 8 from its
// middle to its end, and an offset x the phase k a x / range. At `ratio` times the wavenumber both
// are those of the sent frequency at another range, nearer the focus, and at another offset. Of
// what is in focus only the offset changes.
#pragma once

#include "hw/probe/acquisition_plan.h"
#include "sim/beam/table/beam_table.h"

namespace wobblebench::sim {

/// Rows of the table that stand for one row.
struct LowerBeam {
  int lateral_row;
  int elevation_row;
  /// Offsets in those rows over true offsets.
  double lateral_scale = 1;
  double elevation_scale = 1;
  /// Factors on amplitudes: of a point, which is louder where the beam is less out of focus; and of
  /// even tissue, so that its echo over `ratio` is what it was.
  double point_gain = 1;
  double tissue_gain = 1;
};

class LowerFrequency {
 public:
  /// `table` must outlive it.
  LowerFrequency(const hw::AcquisitionPlan& plan, const BeamTable& table);

  /// `ratio`: of the frequency over the one sent, at most 1.
  LowerBeam at(int row, double ratio) const;

 private:
  double range_m(int row) const { return (row + 0.5) / table_.rows_per_m(); }
  double lateral_scale(double range_m, double nearer_m, double ratio) const;
  double area_m2(const LowerBeam& beam) const;

  hw::AcquisitionPlan plan_;
  PulseBand band_;
  const BeamTable& table_;
};

}  // namespace wobblebench::sim
