// The mean fetal head by itself, as what a head of unknown identity is compared with.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// The skin of the mean head of 26 weeks, without neck and body. Head frame (docs/units.md):
/// metres, x to the right of an observer who faces it, y to the chin, z to the occiput; the origin
/// lies within, in the middle of what is seen from before.
///
/// @code
/// const phantoms::MeanHead head;
/// const auto inside = head.distance({0, 0, 0});
/// if (inside.value_m > 0) return;
/// @endcode
class MeanHead {
 public:
  MeanHead();

  struct Distance {
    double value_m = 0;      ///< negative within
    glm::dvec3 gradient{0};  ///< per metre
  };
  /// At any position; to first order near the surface, some percent off far away.
  Distance distance(const glm::dvec3& position_m) const;

  /// Points of the skin, some 3 mm apart.
  const std::vector<glm::dvec3>& skin_m() const { return skin_m_; }
  /// Radius about the origin of a ball that contains the head.
  double reach_m() const { return reach_m_; }

  /// Bounds, about the origin, of the head as `rotation` turns it (turned_skin()).
  Box turned_bounds(const glm::dmat3& rotation) const;

 private:
  float& at(const glm::ivec3& cell);

  glm::ivec3 size_{0};
  glm::dvec3 low_m_{0};
  std::vector<float> distance_m_;  // [z][y][x]
  std::vector<glm::dvec3> skin_m_;
  double reach_m_ = 0;
};

}  // namespace wobblebench::phantoms
