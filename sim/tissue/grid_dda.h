// Grid traversal by a digital differential analyser: the cells of a tissue map along a straight
// line (Amanatides and Woo 1987).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

class GridDda {
 public:
  /// Along the line from range `from_m` at `origin` (rest frame) to range `to_m`. `direction`:
  /// metres at rest for each metre of range.
  GridDda(const TissueMap& map,
          const glm::dvec3& origin,
          const glm::dvec3& direction,
          double from_m,
          double to_m)
      : cell_(map.cell_at(origin)), range_m_(from_m), end_m_(to_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const double speed = direction[axis];
      step_[axis] = speed < 0 ? -1 : 1;
      const double wall = map.origin_m()[axis] + (cell_[axis] + (speed < 0 ? 0 : 1)) * map.cell_m();
      const double never = std::numeric_limits<double>::infinity();
      next_[axis] = speed == 0 ? never : from_m + std::max(0.0, (wall - origin[axis]) / speed);
      stride_[axis] = speed == 0 ? never : map.cell_m() / std::abs(speed);
    }
  }

  bool done() const { return range_m_ >= end_m_; }
  const glm::ivec3& cell() const { return cell_; }
  /// Ranges at which the line enters and leaves the cell.
  double from_m() const { return range_m_; }
  double to_m() const { return std::min(end_m_, next_[nearest()]); }

  void advance() {
    const int axis = nearest();
    range_m_ = next_[axis];
    cell_[axis] += step_[axis];
    next_[axis] += stride_[axis];
  }

 private:
  int nearest() const {
    if (next_.x <= next_.y) return next_.x <= next_.z ? 0 : 2;
    return next_.y <= next_.z ? 1 : 2;
  }

  glm::ivec3 cell_;
  glm::ivec3 step_{0};
  glm::dvec3 next_{0};
  glm::dvec3 stride_{0};
  double range_m_;
  double end_m_;
};

}  // namespace wobblebench::sim
