#include "bench/evaluation/truth/scanned_surfaces.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "base/duration.h"

namespace wobblebench::bench {

namespace {

/// Behind a crossing of the wrong sign the search continues from this distance on.
constexpr double kPastCrossing_m = 1e-5;
/// Half step of the central differences of to_rest().
constexpr double kHalfStep_m = 1e-4;

/// The axis-aligned box in the phantom frame that contains a box of the probe frame.
phantoms::Box in_phantom(const render::VolumeOfInterest& probe_box,
                         const phantoms::Placement& placement) {
  phantoms::Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
                    glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 at;
    for (int axis = 0; axis < 3; ++axis) {
      const double side = (corner >> axis & 1) == 0 ? -0.5 : 0.5;
      at[axis] = probe_box.center_m[axis] + side * probe_box.size_m[axis];
    }
    const glm::dvec3 p = placement.to_phantom(at);
    box = {glm::min(box.low, p), glm::max(box.high, p)};
  }
  return box;
}

std::vector<phantoms::Deformation> moments_of(const phantoms::Motion& motion,
                                              const hw::AcquisitionPlan& plan,
                                              std::uint32_t volume) {
  std::vector<phantoms::Deformation> moments;
  if (motion.still()) return moments;
  const auto& acquisition = plan.acquisition();
  for (std::uint32_t f = 0; f < static_cast<std::uint32_t>(acquisition.frames_per_volume); ++f) {
    for (std::uint32_t l = 0; l < static_cast<std::uint32_t>(acquisition.sticks_per_frame); ++l) {
      moments.push_back(
          motion.at(to_seconds(plan.stick_time(plan.sequence({volume, f, l})).time_since_epoch())));
    }
  }
  return moments;
}

constexpr int kPointsAcross = 9;
constexpr int kSteps = 128;
constexpr double kSpeedMargin = 1.5, kStretchMargin = 1.2;
/// Margin beyond the sampled points, where a phantom bends.
constexpr double kBend_m = 2e-3;
constexpr double kNeighbour_m = 1e-4;

std::vector<glm::dvec3> grid_points(const phantoms::Box& box) {
  const glm::dvec3 step = (box.high - box.low) / (kPointsAcross - 1.0);
  std::vector<glm::dvec3> points;
  for (int x = 0; x < kPointsAcross; ++x) {
    for (int y = 0; y < kPointsAcross; ++y) {
      for (int z = 0; z < kPointsAcross; ++z)
        points.push_back(box.low + step * glm::dvec3(x, y, z));
    }
  }
  return points;
}

/// Largest distance at rest of two neighbouring points over their distance now.
double stretch_at(const phantoms::Deformation& moment,
                  const glm::dvec3& now_m,
                  const glm::dvec3& rest) {
  double stretch = 1;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 neighbour = now_m;
    neighbour[axis] += kNeighbour_m;
    stretch = std::max(stretch, glm::distance(moment.to_rest(neighbour), rest) / kNeighbour_m);
  }
  return stretch;
}

/// Bounds of a motion without a mouth, which is smooth enough to be sampled.
MotionBounds sampled_bounds(const phantoms::Motion& motion,
                            const phantoms::Box& box,
                            double begin_s,
                            double end_s) {
  MotionBounds bounds{0, 1, box};
  if (motion.still()) return bounds;
  const std::vector<glm::dvec3> points = grid_points(box);
  std::vector<glm::dvec3> before = points;
  const phantoms::Deformation start = motion.at(begin_s);
  for (glm::dvec3& point : before) {
    point = start.to_rest(point);
    bounds.at_rest = {glm::min(bounds.at_rest.low, point), glm::max(bounds.at_rest.high, point)};
  }
  const double step_s = (end_s - begin_s) / kSteps;
  for (int i = 1; i <= kSteps; ++i) {
    const phantoms::Deformation moment = motion.at(begin_s + i * step_s);
    for (std::size_t p = 0; p < points.size(); ++p) {
      const glm::dvec3 rest = moment.to_rest(points[p]);
      bounds.speed_m_s = std::max(bounds.speed_m_s, glm::distance(rest, before[p]) / step_s);
      bounds.at_rest = {glm::min(bounds.at_rest.low, rest), glm::max(bounds.at_rest.high, rest)};
      if (!motion.rigid()) {
        bounds.stretch = std::max(bounds.stretch, stretch_at(moment, points[p], rest));
      }
      before[p] = rest;
    }
  }
  bounds.speed_m_s *= kSpeedMargin;
  if (motion.rigid()) return bounds;
  bounds.stretch *= kStretchMargin;
  bounds.at_rest = {bounds.at_rest.low - kBend_m, bounds.at_rest.high + kBend_m};
  return bounds;
}

/// Step where no longer one is safe: far below a voxel.
constexpr double kLeastStep_m = 0.1e-3;
constexpr double kBisected_m = 1e-6;
constexpr int kDisplacementSamples = 4;

/// For points in `box` (phantom frame) from time `begin_s` to `end_s`.
MotionBounds motion_bounds(const phantoms::Motion& motion,
                           const phantoms::Box& box,
                           double begin_s,
                           double end_s) {
  MotionBounds bounds = sampled_bounds(motion.without_mouth(), box, begin_s, end_s);
  // The mouth is smaller than the samples' spacing: its bounds are in closed form.
  const phantoms::Motion::MouthBounds mouth = motion.mouth_bounds();
  bounds.speed_m_s = mouth.stretch * bounds.speed_m_s + mouth.speed_m_s;
  bounds.stretch *= mouth.stretch;
  bounds.at_rest.low -= mouth.shift_m;
  bounds.at_rest.high += mouth.shift_m;
  return bounds;
}

}  // namespace

ScannedSurfaces::ScannedSurfaces(const phantoms::PlacedPhantom& subject,
                                 const hw::AcquisitionPlan& plan,
                                 const render::View& view,
                                 double reach_m,
                                 std::uint32_t volume)
    : volume_(volume),
      subject_(subject),
      plan_(plan),
      geometry_(plan.geometry()),
      box_(view.box),
      edge_(view.edge),
      bounds_(
          motion_bounds(subject.motion,
                        in_phantom(view.box, subject.placement),
                        to_seconds(plan.stick_time(plan.first_sequence(volume)).time_since_epoch()),
                        to_seconds(plan.volume_end_time(volume).time_since_epoch()))),
      finder_(subject.phantom, reach_m, bounds_.at_rest),
      moments_(std::make_shared<const std::vector<phantoms::Deformation>>(
          moments_of(subject.motion, plan, volume))) {}

hw::StickIndex ScannedSurfaces::stick_at(const glm::dvec3& position_m) const {
  return plan_.nearest_stick(geometry_.to_polar(position_m), volume_);
}

glm::dvec3 ScannedSurfaces::to_rest(const glm::dvec3& position_m,
                                    const hw::StickIndex& stick) const {
  const glm::dvec3 moved_m = subject_.placement.to_phantom(position_m);
  return moments_->empty() ? moved_m : moment_of(stick).to_rest(moved_m);
}

const phantoms::Deformation& ScannedSurfaces::moment_of(const hw::StickIndex& stick) const {
  const auto lines = static_cast<std::size_t>(plan_.acquisition().sticks_per_frame);
  return (*moments_)[stick.frame * lines + stick.line];
}

/// The gradient of distance(to_rest(x)): the transposed Jacobian of to_rest() times the gradient at
/// rest.
glm::dvec3 ScannedSurfaces::gradient_at_stick(const glm::dvec3& position_m,
                                              const hw::StickIndex& stick,
                                              const glm::dvec3& gradient) const {
  if (subject_.motion.still()) return subject_.placement.direction_to_probe(gradient);
  glm::dvec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0);
    step[axis] = kHalfStep_m;
    const glm::dvec3 moved = to_rest(position_m + step, stick) - to_rest(position_m - step, stick);
    result[axis] = glm::dot(moved, gradient) / (2 * kHalfStep_m);
  }
  return result;
}

std::optional<phantoms::SurfaceFinder::Distance> ScannedSurfaces::distance(
    const glm::dvec3& position_m, const hw::StickIndex& stick) const {
  auto distance = finder_.distance(to_rest(position_m, stick));
  if (distance) distance->gradient = gradient_at_stick(position_m, stick, distance->gradient);
  return distance;
}

glm::dvec3 ScannedSurfaces::outward(int surface, const glm::dvec3& normal) const {
  const auto inside = subject_.phantom.surfaces().at(static_cast<std::size_t>(surface)).inside;
  const auto& material = subject_.phantom.materials().at(static_cast<std::size_t>(inside));
  return material.backscatter_db > kTissueBackscatter_db ? normal : -normal;
}

std::optional<SurfaceCrossing> ScannedSurfaces::first(const hw::Ray& ray) const {
  const render::Span span = render::clip_to_box(ray, box_);
  return subject_.motion.still() ? first_of_still(ray, span) : first_of_moving(ray, span);
}

std::optional<SurfaceCrossing> ScannedSurfaces::first_of_still(const hw::Ray& ray,
                                                               render::Span span) const {
  const glm::dvec3 origin = subject_.placement.to_phantom(ray.origin);
  const glm::dvec3 direction = subject_.placement.direction_to_phantom(ray.direction);
  while (span.from_m < span.to_m) {
    const auto hit = finder_.first_hit(origin, direction, span.from_m, span.to_m);
    if (!hit) return std::nullopt;
    const glm::dvec3 out = outward(hit->surface, hit->normal);
    const bool enters_tissue = glm::dot(out, direction) < 0;
    if (enters_tissue == (edge_ == render::EdgeSign::rising)) {
      return SurfaceCrossing{
          hit->distance_m, subject_.placement.direction_to_probe(out), hit->surface};
    }
    span.from_m = hit->distance_m + kPastCrossing_m;
  }
  return std::nullopt;
}

void ScannedSurfaces::sample(const hw::Ray& ray, double at_m, RaySample& sample) const {
  const glm::dvec3 position = ray.at(at_m);
  sample.at_m = at_m;
  sample.stick = stick_at(position);
  sample.rest_m = to_rest(position, sample.stick);
  sample.distance_m.clear();
  for (int target = 0; target < finder_.targets(); ++target) {
    sample.distance_m.push_back(finder_.distance_bound(target, sample.rest_m));
  }
}

/// Upper bound of the distance between the rest positions of `from` and of any point of the ray up
/// to `step_m` beyond it, all at the time of `from`.
double ScannedSurfaces::rest_displacement_m(const hw::Ray& ray,
                                            const RaySample& from,
                                            double step_m) const {
  if (subject_.motion.rigid()) return step_m;
  // Most of a head turns rigidly, and most of what is around it not at all.
  if (moment_of(from.stick).rigid_radius_m(from.rest_m) >= step_m) return step_m;
  double farthest = 0;
  for (int i = 1; i <= kDisplacementSamples; ++i) {
    const glm::dvec3 rest =
        to_rest(ray.at(from.at_m + step_m * i / kDisplacementSamples), from.stick);
    farthest = std::max(farthest, glm::distance(rest, from.rest_m));
  }
  return farthest + bounds_.stretch * step_m / (2 * kDisplacementSamples);
}

/// Upper bound of the time between the stick of `from` and that of any point of the ray up to
/// `step_m` beyond it. Frame numbers are monotonic along a straight ray; line numbers may turn
/// back, but change by no more than the step's length allows.
double ScannedSurfaces::time_difference_s(const hw::Ray& ray,
                                          const RaySample& from,
                                          double step_m) const {
  const hw::StickIndex there = stick_at(ray.at(from.at_m + step_m));
  const double lines = plan_.acquisition().sticks_per_frame;
  const double frames = std::abs(1.0 * there.frame - 1.0 * from.stick.frame);
  const double line_step_m = geometry_.radius_m() * plan_.theta_step_rad();
  const double turned = lines > 1 ? std::min(lines, step_m / line_step_m + 1) : 0;
  return plan_.stick_period_s() * (frames * lines + turned);
}

/// A step along the ray within which no surface can be crossed, whatever moves meanwhile.
double ScannedSurfaces::safe_step_m(const hw::Ray& ray, const RaySample& from) const {
  double clear_m = std::numeric_limits<double>::infinity();
  for (const double distance : from.distance_m) clear_m = std::min(clear_m, std::abs(distance));
  double step_m = 0.9 * clear_m;
  while (step_m > kLeastStep_m) {
    const double moved_m = bounds_.speed_m_s * time_difference_s(ray, from, step_m);
    if (moved_m < clear_m && rest_displacement_m(ray, from, step_m) + moved_m <= clear_m)
      return step_m;
    step_m *= 0.6;
  }
  return kLeastStep_m;
}

std::optional<SurfaceCrossing> ScannedSurfaces::first_of_moving(const hw::Ray& ray,
                                                                const render::Span& span) const {
  if (!(span.from_m < span.to_m) || finder_.targets() == 0) return std::nullopt;
  RaySample before, behind;
  sample(ray, span.from_m, before);
  while (before.at_m < span.to_m) {
    sample(ray, std::min(span.to_m, before.at_m + safe_step_m(ray, before)), behind);
    std::optional<SurfaceCrossing> nearest;
    for (int target = 0; target < finder_.targets(); ++target) {
      const auto found = crossing(ray, target, before, behind);
      if (found && (!nearest || found->distance_m < nearest->distance_m)) nearest = found;
    }
    if (nearest) return nearest;
    std::swap(before, behind);
  }
  return std::nullopt;
}

std::optional<SurfaceCrossing> ScannedSurfaces::crossing(const hw::Ray& ray,
                                                         int target,
                                                         RaySample before,
                                                         RaySample behind) const {
  const auto t = static_cast<std::size_t>(target);
  const auto inside = [t](const RaySample& sample) { return sample.distance_m[t] < 0; };
  if (inside(before) == inside(behind)) return std::nullopt;
  while (behind.at_m - before.at_m > kBisected_m) {
    RaySample middle;
    sample(ray, 0.5 * (before.at_m + behind.at_m), middle);
    (inside(middle) == inside(before) ? before : behind) = std::move(middle);
  }
  const bool outside_is_fluid = outward(finder_.surface(target), {1, 0, 0}).x > 0;
  const bool enters_tissue = inside(behind) == outside_is_fluid;
  if (enters_tissue != (edge_ == render::EdgeSign::rising)) return std::nullopt;
  const auto there = finder_.target_distance(target, behind.rest_m);
  // Outside the box a grid may be cut off, where signs change without a surface. Between two sticks
  // tissue may have moved by more than its narrow band.
  if (!there && before.stick == behind.stick) return std::nullopt;
  glm::dvec3 normal = inside(behind) ? -ray.direction : ray.direction;
  if (there) {
    normal = glm::normalize(gradient_at_stick(ray.at(behind.at_m), behind.stick, there->gradient));
  }
  const int surface = finder_.surface(target);
  return SurfaceCrossing{behind.at_m, outward(surface, normal), surface};
}

}  // namespace wobblebench::bench
