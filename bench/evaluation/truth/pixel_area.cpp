#include "bench/evaluation/truth/pixel_area.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace wobblebench::bench {

double pixel_area_m2(const render::Camera& camera,
                     const hw::Ray& ray,
                     double depth_m,
                     const glm::dvec3& normal) {
  const double cosine = std::abs(glm::dot(ray.direction, normal));
  const double pixel_m2 = camera.pixel_m() * camera.pixel_m();
  double across_m2 = pixel_m2;  // perpendicular to the ray
  if (camera.projection == render::Projection::perspective) {
    const double off_axis = glm::dot(ray.direction, camera.forward);
    const double scale = depth_m / camera.eye_distance_m;
    across_m2 = pixel_m2 * scale * scale * off_axis * off_axis * off_axis;
  }
  return across_m2 / std::max(cosine, kLeastCosine);
}

double pixel_area_m2(const Truth& truth, const render::Camera& camera, int column, int row) {
  return pixel_area_m2(camera,
                       camera.ray(column, row),
                       static_cast<double>(truth.any_depth_m(column, row)),
                       truth.normal.at(column, row));
}

}  // namespace wobblebench::bench
