// The two-way beam as a table: amplitude, phase and frequency slope of the echo of a scatterer off
// the stick's axis.
//
// Over a wide band the beam is narrower for high frequencies than for low ones, so that echoes from
// its edge have less of the high ones. Around the centre frequency the response is taken as linear,
//   H(f) = A + B (f - f0) / f0,
// which the pulse and its derivative can represent. The curvature of the wave front is stored
// apart, so that A and B vary slowly: at an offset u an echo appears delay + curvature * u^2
// farther away.
#pragma once

#include <cstddef>
#include <vector>

namespace wobblebench::hw {
class AcquisitionPlan;
}

namespace wobblebench::sim {

enum class BeamShape {
  main_lobe,   ///< the response of sim/beam/beam_pattern.h to the edge of its main lobe
  side_lobes,  ///< the same with three side lobes
};

/// One direction across the beam at one range.
struct BeamRow {
  float columns_per_m = 0;  ///< of offset; there is no echo beyond the last column
  float delay_m = 0;        ///< of the echo's apparent range
  float curvature_per_m = 0;
};

class BeamTable {
 public:
  /// Upper bound of the entries in one direction: their index fits 16 bits.
  static constexpr int kMaxEntries = 1 << 16;

  /// Results do not depend on `threads` (0: all that the machine has).
  BeamTable(const hw::AcquisitionPlan& plan, BeamShape shape, int threads = 0);

  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(lateral_.rows.size()); }
  double rows_per_m() const { return rows_per_m_; }
  /// The row that contains a range, clamped to the table.
  int row(double range_m) const;

  /// H at one position: amplitude * exp(2 pi i cycles) * (1 + slope * (f - f0) / f0). For the
  /// product of both directions amplitudes multiply, phases add, and so do slopes (their product is
  /// neglected).
  struct Value {
    float amplitude = 0;
    float cycles = 0;
    float slope_re = 0;
    float slope_im = 0;
  };
  struct Direction {
    std::vector<BeamRow> rows;
    /// [row][column], at the middle of the column.
    std::vector<Value> values;
  };
  const Direction& lateral() const { return lateral_; }
  const Direction& elevation() const { return elevation_; }
  /// Largest offset that echoes (m).
  double reach_m(const Direction& direction, int row) const {
    return columns_ /
           static_cast<double>(direction.rows[static_cast<std::size_t>(row)].columns_per_m);
  }

  /// Equivalent area: the integral of the echo power over the cross-section, over that of a
  /// scatterer on the axis.
  double area_m2(int row) const { return area_m2_[static_cast<std::size_t>(row)]; }

 private:
  int columns_;
  double rows_per_m_;
  Direction lateral_;
  Direction elevation_;
  std::vector<double> area_m2_;
};

}  // namespace wobblebench::sim
