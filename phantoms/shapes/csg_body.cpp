#include "phantoms/shapes/csg_body.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace wobblebench::phantoms {
namespace {

double shape_distance(const Shape& shape, const glm::dvec3& position) {
  return std::visit([&](const auto& s) { return s.distance(position); }, shape);
}

Span shape_within(const Shape& shape, const Ball& ball) {
  return std::visit([&](const auto& s) { return s.within(ball); }, shape);
}

constexpr double kRounding_m = 1e-9;  // far more than that of any distance here

}  // namespace

Shape mirrored(const Shape& shape) {
  const glm::dvec3 flip{-1, 1, 1};
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape)) {
    Ellipsoid other = *ellipsoid;
    other.center *= flip;
    // to_axes may contain a reflection: an ellipsoid is symmetric about its own axes.
    other.to_axes[0] *= -1;
    return other;
  }
  std::vector<TubePoint> points = std::get<Tube>(shape).points();
  for (TubePoint& point : points) point.center *= flip;
  return Tube(std::move(points));
}

void CsgBody::unite_pair(const Shape& shape, double fillet_m) {
  unite(shape, fillet_m);
  unite(mirrored(shape), fillet_m);
}

void CsgBody::subtract_pair(const Shape& shape, double fillet_m) {
  subtract(shape, fillet_m);
  subtract(mirrored(shape), fillet_m);
}

CsgBody::Operation CsgBody::operation(const Shape& shape, double fillet_m, bool is_difference) {
  return {
      shape, fillet_m, is_difference, std::visit([](const auto& s) { return s.bound(); }, shape)};
}

double CsgBody::distance(const glm::dvec3& position) const {
  double body = std::numeric_limits<double>::infinity();
  for (const Operation& operation : operations_) {
    const double lower_bound =
        glm::length(position - operation.bound.center) - operation.bound.radius_m;
    // A fillet has an effect only where the two distances differ by less than its size.
    if (operation.is_difference) {
      if (lower_bound > operation.fillet_m - body) continue;
      body = smooth_difference(body, shape_distance(operation.shape, position), operation.fillet_m);
    } else {
      if (lower_bound > body + operation.fillet_m) continue;
      body = smooth_union(body, shape_distance(operation.shape, position), operation.fillet_m);
    }
  }
  return body;
}

CsgBody CsgBody::near(const Ball& ball) const {
  CsgBody local;
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Span body{kFar, kFar};
  for (const Operation& operation : operations_) {
    const double fillet = operation.fillet_m + kRounding_m;
    const double from_bound =
        glm::length(ball.center - operation.bound.center) - operation.bound.radius_m;
    const Span shape = shape_within(operation.shape, ball);
    // Either distance() skips the operation at every position in the ball, or it has no effect at
    // any.
    const double apart = std::max(from_bound - ball.radius_m, shape.least) - fillet;
    if (apart > (operation.is_difference ? -body.least : body.most)) continue;
    local.operations_.push_back(operation);
    if (auto* tube = std::get_if<Tube>(&local.operations_.back().shape)) *tube = tube->near(ball);
    const double change = operation.fillet_m / 4;
    if (operation.is_difference) {
      body.most = std::max(body.most, -shape.least) + change;
    } else {
      // Where distance() skips it, the body is nearer than its bound.
      const double skipped = from_bound + ball.radius_m - operation.fillet_m;
      body.most = std::min(body.most, std::max(shape.most, skipped));
      body.least = std::min(body.least, shape.least) - change;
    }
  }
  return local;
}

}  // namespace wobblebench::phantoms
