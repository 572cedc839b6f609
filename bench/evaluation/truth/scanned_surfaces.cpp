#include "bench/evaluation/truth/scanned_surfaces.h"

#include <chrono>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace wobblebench::bench {
namespace {

/// Materials above this level are tissue, those below are fluid.
constexpr double kTissueBackscatterDb = -100;
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

double seconds(hw::DeviceTime time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

std::vector<phantoms::Deformation> moments_of(const phantoms::Motion& motion,
                                              const hw::AcquisitionPlan& plan,
                                              std::uint32_t volume) {
  std::vector<phantoms::Deformation> moments;
  if (motion.still()) return moments;
  const auto& acquisition = plan.acquisition();
  for (std::uint32_t f = 0; f < static_cast<std::uint32_t>(acquisition.frames_per_volume); ++f) {
    for (std::uint32_t l = 0; l < static_cast<std::uint32_t>(acquisition.sticks_per_frame); ++l) {
      moments.push_back(motion.at(seconds(plan.stick_time(plan.sequence({volume, f, l})))));
    }
  }
  return moments;
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
      bounds_(motion_bounds(subject.motion,
                            in_phantom(view.box, subject.placement),
                            seconds(plan.stick_time(plan.first_sequence(volume))),
                            seconds(plan.volume_end_time(volume)))),
      finder_(subject.phantom, reach_m, bounds_.at_rest),
      moments_(std::make_shared<const std::vector<phantoms::Deformation>>(
          moments_of(subject.motion, plan, volume))) {}

hw::StickIndex ScannedSurfaces::stick_at(const glm::dvec3& position_m) const {
  return plan_.nearest_stick(geometry_.to_polar(position_m), volume_);
}

glm::dvec3 ScannedSurfaces::to_rest(const glm::dvec3& position_m,
                                    const hw::StickIndex& stick) const {
  const glm::dvec3 moved_m = subject_.placement.to_phantom(position_m);
  if (moments_->empty()) return moved_m;
  const auto lines = static_cast<std::size_t>(plan_.acquisition().sticks_per_frame);
  return (*moments_)[stick.frame * lines + stick.line].to_rest(moved_m);
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
  return material.backscatter_db > kTissueBackscatterDb ? normal : -normal;
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
      return SurfaceCrossing{hit->distance_m, subject_.placement.direction_to_probe(out)};
    }
    span.from_m = hit->distance_m + kPastCrossing_m;
  }
  return std::nullopt;
}

}  // namespace wobblebench::bench
