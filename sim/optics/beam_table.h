// The two-way beam as a table: responses over the band for a scatterer off the stick's axis.
//
// The curvature of the wave front is stored separately, so that the tabulated responses vary
// slowly: at an offset u an echo appears delay + tilt * u + curvature * u^2 farther away. Sticks
// near the end of the array have a lateral table of their own, because part of their aperture is
// missing.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "sim/optics/probe_optics.h"

namespace wobblebench::sim {

enum class BeamShape {
  main_lobe,   ///< the response to the edge of its main lobe
  side_lobes,  ///< the same with three side lobes
};

/// One direction across the beam at one range.
struct BeamRow {
  float columns_per_m = 0;  ///< of offset; there is no echo beyond the last column
  float delay_m = 0;        ///< added to the echo's apparent range
  float tilt = 0;
  float curvature_per_m = 0;
};

/// A property of the rows near one row, as a linear function of range.
struct RowLine {
  double at_face;
  double slope_per_m;

  double at(double range_m) const { return at_face + slope_per_m * range_m; }
};
/// The line through the row's value with the slope between its neighbours. `value(i)`: of row i.
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

  /// `course`: centre frequency of the received pulses, which determines the beam's reach; the
  /// responses are those at the transmitted frequencies.
  BeamTable(const ProbeOptics& optics, BeamShape shape, const FrequencyCourse& course = {});

  /// Columns on one side of the axis.
  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(elevation_.rows.size()); }
  double rows_per_m() const { return rows_per_m_; }
  /// The row that contains a range, clamped to the table.
  int row(double range_m) const;
  /// The part of that row that contains the range, if rows are divided into `parts`.
  int part(double range_m, int parts) const;

  /// Parts of a row with elevation responses of their own: across frames the profile changes by 8 %
  /// over a row, and one table serves all sticks.
  static constexpr int kElevationParts = 2;

  struct Direction {
    std::vector<BeamRow> rows;
    int parts = 1;         ///< per row, along the stick
    int part_columns = 0;  ///< per part
    /// [row][part][column], at the middle of the part and of the column. Lateral: 2 columns(), from
    /// the largest negative offset on. Elevation: columns(), from the axis on, for both signs.
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
  /// Largest offset in a direction at which a scatterer echoes.
  double reach_m(const Direction& direction, int row) const {
    return columns_ /
           static_cast<double>(direction.rows[static_cast<std::size_t>(row)].columns_per_m);
  }
  /// Largest lateral offset at which a scatterer echoes on any stick.
  double lateral_reach_m(int row) const;

  /// Equivalent area of the middle stick's beam: the integral of the echo power over the
  /// cross-section, relative to that of a scatterer whose echo has a peak of 1.
  double area_m2(int row) const;

 private:
  int columns_;
  double rows_per_m_;
  double first_angle_rad_;
  double angle_step_rad_;
  std::vector<Direction> lateral_;
  Direction elevation_;
  PulseBand band_;
  /// [row][node]: power at the node, integrated over the cross-section of the middle stick's beam.
  std::vector<std::array<double, PulseBand::kNodes>> power_m2_;
};

/// Bounds of the beam along a stick: its reach in both directions across the axis, by range.
class BeamBounds {
 public:
  /// Distance between the ranges at which the reach is tabulated.
  static constexpr double kStep_m = 1e-3;

  struct Reach {
    double lateral_m;
    double elevation_m;
  };

  /// `margin_m`: half the diagonal of the bodies that are tested against the bounds.
  BeamBounds(const BeamTable& table,
             const BeamTable::Direction& lateral,
             double depth_m,
             double margin_m);

  /// Largest reach within the margin of a range.
  const Reach& reach(double range_m) const {
    const int i = static_cast<int>(range_m * per_m_);
    return reach_[static_cast<std::size_t>(std::clamp(i, 0, static_cast<int>(reach_.size()) - 1))];
  }
  /// Largest reach at any range.
  const Reach& widest() const { return widest_; }

 private:
  std::vector<Reach> reach_;
  double per_m_;
  Reach widest_{0, 0};
};

}  // namespace wobblebench::sim
