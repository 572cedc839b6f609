// The two-way beam as a table: responses over the band for a scatterer off the stick's axis.
//
// The curvature of the wave front is stored apart, so that responses vary slowly: at an offset u
// an echo appears delay + tilt * u + curvature * u^2 farther away. Sticks near the end of the array
// have a lateral table of their own, because part of their aperture is missing.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "sim/optics/frequency_course.h"
#include "sim/optics/pulse_band.h"
#include "sim/options.h"

namespace wobblebench::sim {

enum class BeamShape {
  main_lobe,   ///< the response to the edge of its main lobe
  side_lobes,  ///< the same with three side lobes
};

/// One direction across the beam at one range.
struct BeamRow {
  float columns_per_m = 0;  ///< of offset; there is no echo beyond the last column
  float delay_m = 0;        ///< of the echo's apparent range
  float tilt = 0;
  float curvature_per_m = 0;
};

/// A property of rows near one of them, linear over range.
struct RowLine {
  double at_face;
  double slope_per_m;

  double at(double range_m) const { return at_face + slope_per_m * range_m; }
};
/// Through the row, as steep as between its neighbours. `value`: of a row.
template <class Value>
RowLine line_around(int row, int rows, double rows_per_m, const Value& value) {
  const int before = std::max(row - 1, 0), behind = std::min(row + 1, rows - 1);
  const auto at = [&](int i) { return static_cast<double>(value(static_cast<std::size_t>(i))); };
  const double slope_per_m = (at(behind) - at(before)) * rows_per_m / std::max(1, behind - before);
  return {at(row) - slope_per_m * (row + 0.5) / rows_per_m, slope_per_m};
}

class BeamTable {
 public:
  /// Upper bound of the entries in one direction: their index fits 16 bits.
  static constexpr int kMaxEntries = 1 << 16;

  /// `course`: of the pulses that are to be heard, which the beam's reach follows; responses
  /// are those of the frequencies sent. Results do not depend on `threads` (0: all that the machine
  /// has).
  BeamTable(const hw::AcquisitionPlan& plan,
            BeamShape shape,
            Apodisation apodisation = Apodisation::rectangular,
            int threads = 0,
            const FrequencyCourse& course = {});

  /// Columns on one side of the axis.
  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(elevation_.rows.size()); }
  double rows_per_m() const { return rows_per_m_; }
  /// The row that contains a range, clamped to the table.
  int row(double range_m) const;
  /// The part of that row, of so many.
  int part(double range_m, int parts) const;

  /// Parts of a row with elevation responses of their own: across frames the profile changes by
  /// 8 % for a row, and one table serves all sticks.
  static constexpr int kElevationParts = 2;

  struct Direction {
    std::vector<BeamRow> rows;
    int parts = 1;         ///< of a row, along the stick
    int part_columns = 0;  ///< of each part
    /// [row][part][column], at the middle of the part and of the column. Lateral:
    /// from the largest negative offset on, 2 columns(); elevation: from the axis on, for both
    /// signs, columns().
    std::vector<BandValues> values;

    const BandValues& at(int row, int part, int column) const {
      return values[static_cast<std::size_t>((std::ptrdiff_t{row} * parts + part) * part_columns +
                                             column)];
    }
  };
  /// Lateral tables for sticks at angles from the middle one outwards, in beam coordinates whose
  /// lateral axis points away from the middle of the sector.
  const std::vector<Direction>& lateral() const { return lateral_; }
  const Direction& elevation() const { return elevation_; }
  /// Index of the lateral table of a stick.
  std::size_t lateral_of(double theta_rad) const;
  /// Largest offset that echoes (m).
  double reach_m(const Direction& direction, int row) const {
    return columns_ /
           static_cast<double>(direction.rows[static_cast<std::size_t>(row)].columns_per_m);
  }

  /// Largest lateral offset that echoes on any stick.
  double lateral_reach_m(int row) const;

  /// Equivalent area of the middle stick's beam: the integral of the echo power over the
  /// cross-section, over that of a scatterer whose echo has a peak of 1.
  /// At a lower frequency of the pulse, likewise.
  double area_m2(int row, double frequency_ratio = 1) const;

 private:
  int columns_;
  double rows_per_m_;
  double first_angle_rad_;
  double angle_step_rad_;
  std::vector<Direction> lateral_;
  Direction elevation_;
  PulseBand band_;
  /// Of each row of the middle stick: the power at each node, integrated across the beam.
  std::vector<std::array<double, PulseBand::kNodes>> power_m2_;
};

}  // namespace wobblebench::sim
