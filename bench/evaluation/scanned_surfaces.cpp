#include "bench/evaluation/scanned_surfaces.h"

#include <chrono>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

namespace wobblebench::bench {
namespace {

/// A material that echoes is tissue; one that does not is fluid.
constexpr double kTissueBackscatterDb = -100;
/// Past a crossing of the wrong sign the search goes on this far behind it.
constexpr double kPastCrossing_m = 1e-5;
/// Of the differences that turn a gradient from rest to now.
constexpr double kArm_m = 1e-4;

/// The box in the phantom frame that holds `places`, wherever the phantom stands.
phantoms::Box in_phantom(const render::VolumeOfInterest& places,
                         const phantoms::Placement& placement) {
  phantoms::Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
                    glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 at;
    for (int axis = 0; axis < 3; ++axis) {
      const double side = (corner >> axis & 1) == 0 ? -0.5 : 0.5;
      at[axis] = places.center_m[axis] + side * places.size_m[axis];
    }
    const glm::dvec3 p = placement.to_phantom(at);
    box = {glm::min(box.low, p), glm::max(box.high, p)};
  }
  return box;
}

double seconds(hw::DeviceTime time) {
  return std::chrono::duration<double>(time.time_since_epoch()).count();
}

std::vector<phantoms::Deformation> moments_of_first_volume(const phantoms::Motion& motion,
                                                      const hw::AcquisitionPlan& plan) {
  std::vector<phantoms::Deformation> moments;
  if (motion.still()) return moments;
  const auto& acquisition = plan.acquisition();
  for (std::uint32_t f = 0; f < static_cast<std::uint32_t>(acquisition.frames_per_volume); ++f) {
    for (std::uint32_t l = 0; l < static_cast<std::uint32_t>(acquisition.sticks_per_frame); ++l) {
      moments.push_back(motion.at(seconds(plan.stick_time(plan.sequence({0, f, l})))));
    }
  }
  return moments;
}

}  // namespace

ScannedSurfaces::ScannedSurfaces(const phantoms::Phantom& phantom,
                                 const phantoms::Placement& placement,
                                 const phantoms::Motion& motion,
                                 const hw::AcquisitionPlan& plan,
                                 const render::VolumeOfInterest& places,
                                 double reach_m)
    : phantom_(phantom),
      placement_(placement),
      motion_(motion),
      plan_(plan),
      geometry_(plan.geometry()),
      bounds_(
          motion_bounds(motion, in_phantom(places, placement), seconds(plan.volume_end_time(0)))),
      finder_(phantom, reach_m, bounds_.at_rest),
      moments_(std::make_shared<const std::vector<phantoms::Deformation>>(
          moments_of_first_volume(motion, plan))) {}

hw::StickIndex ScannedSurfaces::stick_at(const glm::dvec3& position_m) const {
  return plan_.nearest_stick(geometry_.to_polar(position_m), 0);
}

glm::dvec3 ScannedSurfaces::to_rest(const glm::dvec3& position_m,
                                    const hw::StickIndex& stick) const {
  const glm::dvec3 now_m = placement_.to_phantom(position_m);
  if (moments_->empty()) return now_m;
  const auto lines = static_cast<std::size_t>(plan_.acquisition().sticks_per_frame);
  return (*moments_)[stick.frame * lines + stick.line].to_rest(now_m);
}

/// The gradient of distance(to_rest(x)): the motion's derivatives, transposed, times the gradient.
glm::dvec3 ScannedSurfaces::gradient_now(const glm::dvec3& position_m,
                                         const hw::StickIndex& stick,
                                         const glm::dvec3& gradient) const {
  if (motion_.still()) return placement_.direction_to_probe(gradient);
  glm::dvec3 now;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 arm(0);
    arm[axis] = kArm_m;
    const glm::dvec3 moved = to_rest(position_m + arm, stick) - to_rest(position_m - arm, stick);
    now[axis] = glm::dot(moved, gradient) / (2 * kArm_m);
  }
  return now;
}

std::optional<phantoms::SurfaceFinder::Distance> ScannedSurfaces::distance(
    const glm::dvec3& position_m, const hw::StickIndex& stick) const {
  auto distance = finder_.distance(to_rest(position_m, stick));
  if (distance) distance->gradient = gradient_now(position_m, stick, distance->gradient);
  return distance;
}

glm::dvec3 ScannedSurfaces::outward(int surface, const glm::dvec3& normal) const {
  const auto inside = phantom_.surfaces().at(static_cast<std::size_t>(surface)).inside;
  const auto& material = phantom_.materials().at(static_cast<std::size_t>(inside));
  return material.backscatter_db > kTissueBackscatterDb ? normal : -normal;
}

std::optional<SurfaceCrossing> ScannedSurfaces::first(const hw::Ray& ray,
                                                      const render::Span& span,
                                                      render::EdgeSign sign) const {
  return motion_.still() ? first_of_still(ray, span, sign) : first_of_moving(ray, span, sign);
}

std::optional<SurfaceCrossing> ScannedSurfaces::first_of_still(const hw::Ray& ray,
                                                               render::Span span,
                                                               render::EdgeSign sign) const {
  const glm::dvec3 origin = placement_.to_phantom(ray.origin);
  const glm::dvec3 direction = placement_.direction_to_phantom(ray.direction);
  while (span.from_m < span.to_m) {
    const auto hit = finder_.first_hit(origin, direction, span.from_m, span.to_m);
    if (!hit) return std::nullopt;
    const glm::dvec3 out = outward(hit->surface, hit->normal);
    const bool enters_tissue = glm::dot(out, direction) < 0;
    if (enters_tissue == (sign == render::EdgeSign::rising)) {
      return SurfaceCrossing{hit->distance_m, placement_.direction_to_probe(out)};
    }
    span.from_m = hit->distance_m + kPastCrossing_m;
  }
  return std::nullopt;
}

}  // namespace wobblebench::bench
