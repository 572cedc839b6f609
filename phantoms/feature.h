// Named parts of a phantom, for measures by part.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace wobblebench::phantoms {

struct FeatureBall {
  glm::dvec3 center_m{0};
  double radius_m = 0;
};

/// What lies within one of some balls, in the phantom frame at rest.
struct Feature {
  std::string name;
  std::vector<FeatureBall> balls;

  bool contains(const glm::dvec3& rest_m) const {
    for (const FeatureBall& ball : balls) {
      if (glm::distance(rest_m, ball.center_m) < ball.radius_m) return true;
    }
    return false;
  }
};

}  // namespace wobblebench::phantoms
