#include "phantoms/shapes/sculpture.h"

#include <glm/geometric.hpp>
#include <limits>

namespace wobblebench::phantoms {
namespace {

double shape_distance(const Shape& shape, const glm::dvec3& position) {
  return std::visit([&](const auto& s) { return s.distance(position); }, shape);
}

}  // namespace

Shape mirrored(const Shape& shape) {
  const glm::dvec3 flip{-1, 1, 1};
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) {
    Ellipsoid other = *ellipsoid;
    other.center *= flip;
    // An ellipsoid does not mind a reflection of its own axes.
    other.to_axes[0] *= -1;
    return other;
  }
  Tube other = std::get<Tube>(shape);
  for (TubePoint& point : other.points) point.center *= flip;
  return other;
}

void Sculpture::add_pair(const Shape& shape, double fillet_m) {
  add(shape, fillet_m);
  add(mirrored(shape), fillet_m);
}

void Sculpture::carve_pair(const Shape& shape, double fillet_m) {
  carve(shape, fillet_m);
  carve(mirrored(shape), fillet_m);
}

Sculpture::Stroke Sculpture::stroke(const Shape& shape, double fillet_m, bool carves) {
  return {shape, fillet_m, carves, std::visit([](const auto& s) { return s.bound(); }, shape)};
}

double Sculpture::distance(const glm::dvec3& position) const {
  double body = std::numeric_limits<double>::infinity();
  for (const Stroke& stroke : strokes_) {
    const double at_least = glm::length(position - stroke.bound.center) - stroke.bound.radius_m;
    // A fillet acts only where both distances differ by less than its size.
    if (stroke.carves) {
      if (at_least > stroke.fillet_m - body) continue;
      body = smooth_difference(body, shape_distance(stroke.shape, position), stroke.fillet_m);
    } else {
      if (at_least > body + stroke.fillet_m) continue;
      body = smooth_union(body, shape_distance(stroke.shape, position), stroke.fillet_m);
    }
  }
  return body;
}

}  // namespace wobblebench::phantoms
