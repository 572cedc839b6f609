// The two-way beam as a table: how strongly, and with which phase and colour, a scatterer echoes
// that lies off the stick's axis.
//
// A wide band makes the beam narrower for its high frequencies than for its low ones, so that
// echoes from its rim are darker in colour: around the centre frequency the response is
//   H(f) = A + B (f - f0) / f0,
// which one pulse and its derivative can show. What bends with the wave front is kept apart: an
// echo from `u` aside is late as if it came from late + bend * u^2 farther away, so that A and B
// vary slowly.
#pragma once

#include <cstddef>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

enum class BeamShape {
  main_lobe,   ///< what the apertures make (sim/beam/beam_pattern.h), to the edge of its main lobe
  side_lobes,  ///< the same with three side lobes
};

/// One direction across the beam at one range.
struct BeamRow {
  float columns_per_m = 0;  ///< of the table; beyond its last column there is no echo
  float late_m = 0;
  float bend_per_m = 0;
};

class BeamTable {
 public:
  /// In one direction; their numbers fit 16 bits.
  static constexpr int kMostPlaces = 1 << 16;

  /// Results do not depend on `threads` (0: all that the machine has).
  BeamTable(const hw::AcquisitionPlan& plan, BeamShape shape, int threads = 0);

  int columns() const { return columns_; }
  int rows() const { return static_cast<int>(lateral_.rows.size()); }
  double rows_per_m() const { return rows_per_m_; }
  /// Row whose middle is nearest to a range; the rim's rows beyond both ends.
  int row(double range_m) const;

  /// H at one place: amplitude * exp(2 pi i cycles) * (1 + colour * (f - f0) / f0). In the product
  /// of both directions amplitudes multiply; phases and colours add (but for the colours' product).
  struct Value {
    float amplitude = 0;
    float cycles = 0;
    float colour_re = 0;
    float colour_im = 0;
  };
  struct Direction {
    std::vector<BeamRow> rows;
    /// [row][column]: in the middle of the column's share of the offset.
    std::vector<Value> values;
  };
  const Direction& lateral() const { return lateral_; }
  const Direction& elevation() const { return elevation_; }
  double reach_m(const Direction& direction, int row) const {
    return columns_ /
           static_cast<double>(direction.rows[static_cast<std::size_t>(row)].columns_per_m);
  }

  /// Integral of the echo's power over the cross-section, over that of a scatterer on the axis: an
  /// area that echoes evenly.
  double area_m2(int row) const { return area_m2_[static_cast<std::size_t>(row)]; }

 private:
  int columns_;
  double rows_per_m_;
  Direction lateral_;
  Direction elevation_;
  std::vector<double> area_m2_;
};

}  // namespace wobblebench::sim
