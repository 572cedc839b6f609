#include "phantoms/fetal/head_extent.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "base/units.h"

namespace wobblebench::phantoms {

// A distance to first order may lead through the surface, above all from the middle of a hollow:
// then it is sought back in that step.
glm::dvec3 first_point(const CsgBody& body, const Ray& ray) {
  constexpr double kNear_m = 1e-8, kReach_m = 0.2;
  constexpr int kSteps = 300;
  const double side = body.distance(ray.origin) < 0 ? -1 : 1;
  double before = 0, travelled = 0;
  for (int step = 0; step < kSteps && travelled < kReach_m; ++step) {
    const double gap = side * body.distance(ray.at(travelled));
    if (gap < -kNear_m) {
      const double middle = 0.5 * (before + travelled);
      (side * body.distance(ray.at(middle)) < 0 ? travelled : before) = middle;
      continue;
    }
    if (gap < kNear_m) break;
    before = travelled;
    travelled += 0.85 * gap;
  }
  return ray.at(travelled);
}

namespace {

// The outermost points of a body in directions that are spread evenly about a point within.
std::vector<glm::dvec3> points_around(const CsgBody& body, const glm::dvec3& center_m) {
  constexpr int kDirections = 1500;
  constexpr double kFrom_m = 0.15;
  std::vector<glm::dvec3> points;
  for (int i = 0; i < kDirections; ++i) {
    // Fibonacci sphere.
    const double y = 1 - 2 * (i + 0.5) / kDirections, around = i * kPi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - y * y);
    const glm::dvec3 outwards{r * std::cos(around), y, r * std::sin(around)};
    points.push_back(first_point(body, {center_m + kFrom_m * outwards, -outwards}));
  }
  return points;
}

// Whether a point of the skin is the first on the ray along this unit vector.
bool is_seen(const FetalHead& head, const glm::dvec3& skin_m, const glm::dvec3& along) {
  constexpr double kFrom_m = 0.15, kNear_m = 0.3e-3;
  return glm::distance(first_point(head.skin, {skin_m - kFrom_m * along, along}), skin_m) < kNear_m;
}

}  // namespace

double reach_of_skull(const FetalHead& head, const glm::dvec3& center_m) {
  double reach = 0;
  for (const glm::dvec3& point : points_around(head.skull, center_m)) {
    reach = std::max(reach, glm::distance(point, center_m));
  }
  for (const Ellipsoid& eye : head.eyes) {
    reach = std::max(reach, glm::distance(eye.center, center_m) + eye.radii_m.x);
  }
  return reach;
}

glm::dvec3 middle_of_skull(const HeadShape& shape) {
  return shape.unit_m * glm::dvec3(0, -0.065 * shape.biparietal, 0.48 * shape.occipitofrontal);
}

std::vector<glm::dvec3> skin_points(const FetalHead& head, const glm::dvec3& center_m) {
  return points_around(head.skin, center_m);
}

Box turned_skin(const FetalHead& head, const glm::dvec3& center_m, const glm::dmat3& rotation) {
  const glm::dvec3 along = glm::transpose(rotation) * glm::dvec3(0, 0, 1);
  Box bounds{glm::dvec3(std::numeric_limits<double>::infinity()),
             glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (const glm::dvec3& point : skin_points(head, center_m)) {
    glm::dvec3 turned = rotation * point;
    bounds.low = glm::min(bounds.low, turned);
    if (!is_seen(head, point, along)) turned.z = bounds.high.z;
    bounds.high = glm::max(bounds.high, turned);
  }
  return bounds;
}

}  // namespace wobblebench::phantoms
