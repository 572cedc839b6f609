#include "bench/evaluation/pixel_area.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace wobblebench::bench {

double pixel_area_m2(const Truth& truth, const render::Camera& camera, int column, int row) {
  const glm::dvec3 direction = camera.ray(column, row).direction;
  const double cosine = std::abs(glm::dot(direction, glm::dvec3(truth.normal.at(column, row))));
  const double pixel_m2 = camera.pixel_m() * camera.pixel_m();
  double across_m2 = pixel_m2;  // perpendicular to the ray
  if (camera.projection == render::Projection::perspective) {
    const double off_axis = glm::dot(direction, camera.forward);
    const double scale = static_cast<double>(truth.depth_m.at(column, row)) / camera.eye_distance_m;
    across_m2 = pixel_m2 * scale * scale * off_axis * off_axis * off_axis;
  }
  return across_m2 / std::max(cosine, kLeastCosine);
}

}  // namespace wobblebench::bench
