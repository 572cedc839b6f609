#include "phantoms/shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace wobblebench::phantoms {
namespace {

constexpr double kRounding_m = 1e-9;  // far more than that of any distance here

// Exact distance to the convex hull of two balls.
double round_cone_distance(const glm::dvec3& position, const TubePoint& a, const TubePoint& b) {
  const glm::dvec3 axis = b.center - a.center;
  const double length2 = glm::dot(axis, axis);
  const double taper = a.radius_m - b.radius_m;
  const glm::dvec3 from_a = position - a.center;
  if (length2 <= taper * taper) {  // one ball contains the other
    return taper > 0 ? glm::length(from_a) - a.radius_m
                     : glm::length(position - b.center) - b.radius_m;
  }
  const double along = glm::dot(from_a, axis) / length2;
  const glm::dvec3 across = from_a - along * axis;
  const double radial = glm::length(across);
  const double slope = taper / std::sqrt(length2 - taper * taper);
  const double foot = along - slope * radial / std::sqrt(length2);
  if (foot <= 0) return glm::length(from_a) - a.radius_m;
  if (foot >= 1) return glm::length(position - b.center) - b.radius_m;
  return glm::length(position - a.center - foot * axis) - (a.radius_m - foot * taper);
}

TubePoint catmull_rom(const TubePoint& before,
                      const TubePoint& from,
                      const TubePoint& to,
                      const TubePoint& after,
                      double t) {
  const double t2 = t * t, t3 = t2 * t;
  const auto blend = [&](const auto& p0, const auto& p1, const auto& p2, const auto& p3) {
    return 0.5 * (2.0 * p1 + t * (p2 - p0) + t2 * (2.0 * p0 - 5.0 * p1 + 4.0 * p2 - p3) +
                  t3 * (3.0 * p1 - p0 - 3.0 * p2 + p3));
  };
  return {blend(before.center, from.center, to.center, after.center),
          blend(before.radius_m, from.radius_m, to.radius_m, after.radius_m)};
}

}  // namespace

double Ellipsoid::distance(const glm::dvec3& position) const {
  const glm::dvec3 local = to_axes * (position - center);
  const double k0 = glm::length(local / radii_m);
  const double k1 = glm::length(local / (radii_m * radii_m));
  if (k1 == 0) return -std::min({radii_m.x, radii_m.y, radii_m.z});
  return k0 * (k0 - 1) / k1;
}

// With k0 as in distance(), that is (k0 - 1) times a length between the least and the largest
// radius.
Span Ellipsoid::within(const Ball& ball) const {
  const double least = std::min({radii_m.x, radii_m.y, radii_m.z});
  const double most = std::max({radii_m.x, radii_m.y, radii_m.z});
  const double k0 = glm::length(to_axes * (ball.center - center) / radii_m);
  const double nearest = k0 - ball.radius_m / least - 1, farthest = k0 + ball.radius_m / least - 1;
  return {nearest * (nearest > 0 ? least : most), farthest * (farthest > 0 ? most : least)};
}

Ball Ellipsoid::bound() const {
  return {center, std::max({radii_m.x, radii_m.y, radii_m.z})};
}

double Tube::distance(const glm::dvec3& position) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < points.size(); ++i) {
    nearest = std::min(nearest, round_cone_distance(position, points[i - 1], points[i]));
  }
  return nearest;
}

// Round cones are 1-Lipschitz.
Span Tube::within(const Ball& ball) const {
  const double middle = distance(ball.center);
  return {middle - ball.radius_m, middle + ball.radius_m};
}

Tube Tube::near(const Ball& ball) const {
  const double limit = distance(ball.center) + 2 * ball.radius_m + kRounding_m;
  std::size_t first = points.size(), last = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (round_cone_distance(ball.center, points[i - 1], points[i]) > limit) continue;
    first = std::min(first, i - 1);
    last = i;
  }
  return {{points.begin() + static_cast<std::ptrdiff_t>(first),
           points.begin() + static_cast<std::ptrdiff_t>(last) + 1}};
}

Ball Tube::bound() const {
  glm::dvec3 center{0};
  for (const TubePoint& point : points) center += point.center / double(points.size());
  double radius = 0;
  for (const TubePoint& point : points) {
    radius = std::max(radius, glm::length(point.center - center) + point.radius_m);
  }
  return {center, radius};
}

Tube smooth_tube(const std::vector<TubePoint>& points, int pieces) {
  Tube tube;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const TubePoint& before = points[i == 0 ? 0 : i - 1];
    const TubePoint& after = points[std::min(i + 2, points.size() - 1)];
    for (int piece = 0; piece < pieces; ++piece) {
      tube.points.push_back(
          catmull_rom(before, points[i], points[i + 1], after, double(piece) / pieces));
    }
  }
  tube.points.push_back(points.back());
  return tube;
}

double box_distance(const glm::dvec3& position, const glm::dvec3& half_m) {
  const glm::dvec3 beyond = glm::abs(position) - half_m;
  const double inside = std::min(std::max({beyond.x, beyond.y, beyond.z}), 0.0);
  return glm::length(glm::max(beyond, glm::dvec3(0))) + inside;
}

double smooth_union(double a, double b, double fillet_m) {
  const double overlap = std::max(fillet_m - std::abs(a - b), 0.0);
  return std::min(a, b) - (overlap > 0 ? overlap * overlap / (4 * fillet_m) : 0.0);
}

double smooth_difference(double body, double tool, double fillet_m) {
  return -smooth_union(-body, tool, fillet_m);
}

}  // namespace wobblebench::phantoms
