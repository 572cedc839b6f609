// Bounds of the beam along a stick: its reach in both directions across the axis, by range.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/optics/beam_table.h"

namespace wobblebench::sim {

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
