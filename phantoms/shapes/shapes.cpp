#include "phantoms/shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

namespace wobblebench::phantoms {
namespace {

constexpr double kRounding_m = 1e-9;  // far more than that of any distance here

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

double shape_distance(const Shape& shape, const glm::dvec3& position) {
  return std::visit([&](const auto& s) { return s.distance(position); }, shape);
}

Span shape_within(const Shape& shape, const Ball& ball) {
  return std::visit([&](const auto& s) { return s.within(ball); }, shape);
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

RoundCone::RoundCone(const TubePoint& a, const TubePoint& b)
    : a_(a),
      b_(b),
      axis_(b.center - a.center),
      taper_m_(a.radius_m - b.radius_m),
      length2_(glm::dot(axis_, axis_)),
      length_m_(std::sqrt(length2_)),
      is_ball_(length2_ <= taper_m_ * taper_m_),
      bound_{0.5 * (a.center + b.center),
             0.5 * length_m_ + std::max(a.radius_m, b.radius_m) + kRounding_m} {
  if (!is_ball_) slope_ = taper_m_ / std::sqrt(length2_ - taper_m_ * taper_m_);
}

double RoundCone::distance(const glm::dvec3& position) const {
  const glm::dvec3 from_a = position - a_.center;
  if (is_ball_) {
    return taper_m_ > 0 ? glm::length(from_a) - a_.radius_m
                        : glm::length(position - b_.center) - b_.radius_m;
  }
  const double along = glm::dot(from_a, axis_) / length2_;
  double foot = along;
  if (taper_m_ != 0) foot -= slope_ * glm::length(from_a - along * axis_) / length_m_;
  if (foot <= 0) return glm::length(from_a) - a_.radius_m;
  if (foot >= 1) return glm::length(position - b_.center) - b_.radius_m;
  return glm::length(position - a_.center - foot * axis_) - (a_.radius_m - foot * taper_m_);
}

double RoundCone::least_distance(const glm::dvec3& position) const {
  return glm::length(position - bound_.center) - bound_.radius_m;
}

Tube::Tube(std::vector<TubePoint> points) : points_(std::move(points)) {
  for (std::size_t i = 1; i < points_.size(); ++i) cones_.emplace_back(points_[i - 1], points_[i]);
}

double Tube::distance(const glm::dvec3& position) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const RoundCone& cone : cones_) {
    if (cone.least_distance(position) >= nearest) continue;
    nearest = std::min(nearest, cone.distance(position));
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
  std::size_t first = points_.size(), last = 0;
  for (std::size_t i = 0; i < cones_.size(); ++i) {
    if (cones_[i].least_distance(ball.center) > limit) continue;
    if (cones_[i].distance(ball.center) > limit) continue;
    first = std::min(first, i);
    last = i + 1;
  }
  return Tube({points_.begin() + static_cast<std::ptrdiff_t>(first),
               points_.begin() + static_cast<std::ptrdiff_t>(last) + 1});
}

Ball Tube::bound() const {
  glm::dvec3 center{0};
  for (const TubePoint& point : points_) center += point.center / double(points_.size());
  double radius = 0;
  for (const TubePoint& point : points_) {
    radius = std::max(radius, glm::length(point.center - center) + point.radius_m);
  }
  return {center, radius};
}

Tube smooth_tube(const std::vector<TubePoint>& points, int pieces) {
  std::vector<TubePoint> curve;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const TubePoint& before = points[i == 0 ? 0 : i - 1];
    const TubePoint& after = points[std::min(i + 2, points.size() - 1)];
    for (int piece = 0; piece < pieces; ++piece) {
      curve.push_back(catmull_rom(before, points[i], points[i + 1], after, double(piece) / pieces));
    }
  }
  curve.push_back(points.back());
  return Tube(std::move(curve));
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

CsgBody::Operation CsgBody::operation(const Shape& shape,
                                      double fillet_m,
                                      bool is_difference) const {
  const Ball bound = std::visit([](const auto& s) { return s.bound(); }, shape);
  return {shape, fillet_m, is_difference, bound, part_};
}

// wins(operation): its shape is nearer than all before it.
template <class Wins>
double CsgBody::folded(const glm::dvec3& position, const Wins& wins) const {
  double body = std::numeric_limits<double>::infinity();
  for (const Operation& operation : operations_) {
    const double lower_bound =
        glm::length(position - operation.bound.center) - operation.bound.radius_m;
    // A fillet has an effect only where the two distances differ by less than its size.
    if (operation.is_difference) {
      if (lower_bound > operation.fillet_m - body) continue;
      const double tool = shape_distance(operation.shape, position);
      if (-tool > body) wins(operation);
      body = smooth_difference(body, tool, operation.fillet_m);
    } else {
      if (lower_bound > body + operation.fillet_m) continue;
      const double shape = shape_distance(operation.shape, position);
      if (shape < body) wins(operation);
      body = smooth_union(body, shape, operation.fillet_m);
    }
  }
  return body;
}

double CsgBody::distance(const glm::dvec3& position) const {
  return folded(position, [](const Operation&) {});
}

PartDistance CsgBody::part_distance(const glm::dvec3& position) const {
  PartDistance found;
  found.distance = folded(position, [&](const Operation& nearest) { found.part = nearest.part; });
  return found;
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
