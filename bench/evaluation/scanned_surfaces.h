// The surfaces of a phantom as one volume of a scan meets them: each place at the time when the
// stick that shows it was fired. What moves meanwhile is sheared by that, and so is the truth.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "bench/scene/motion_bounds.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/motion.h"
#include "phantoms/phantom.h"
#include "phantoms/truth.h"
#include "render/camera.h"
#include "render/options.h"

namespace wobblebench::bench {

struct SurfaceCrossing {
  double distance_m = 0;  ///< along the ray from its origin
  glm::dvec3 outward{0};  ///< unit, out of the tissue
};

/// The target surfaces in the probe frame, in the first volume of the plan. Places are those within
/// the volume of interest. Several threads each need a copy of their own.
class ScannedSurfaces {
 public:
  /// `reach_m`: distance() knows places at least this near a surface.
  ScannedSurfaces(const phantoms::Phantom& phantom,
                  const phantoms::Placement& placement,
                  const phantoms::Motion& motion,
                  const hw::AcquisitionPlan& plan,
                  const render::VolumeOfInterest& places,
                  double reach_m = 0);

  /// The first crossing from fluid into tissue (rising) or from tissue into fluid (falling). Exact
  /// by OpenVDB's intersector where the phantom is still. Where it moves, the time is that of the
  /// nearest stick, so that a surface may have the steps that the scanner makes.
  std::optional<SurfaceCrossing> first(const hw::Ray& ray,
                                       const render::Span& span,
                                       render::EdgeSign sign) const;

  /// The stick that shows this place: of the nearest frame and line.
  hw::StickIndex stick_at(const glm::dvec3& position_m) const;

  /// Signed distance (negative within the surface) at a place at the time of a stick, and its
  /// gradient; none beyond reach.
  std::optional<phantoms::SurfaceFinder::Distance> distance(const glm::dvec3& position_m,
                                                            const hw::StickIndex& stick) const;

 private:
  /// A place on a ray, with what lies there.
  struct Spot {
    double at_m = 0;
    hw::StickIndex stick;
    glm::dvec3 rest_m{0};
    std::vector<double> distance_m;  ///< to each target, as distance_bound() gives it
  };

  glm::dvec3 to_rest(const glm::dvec3& position_m, const hw::StickIndex& stick) const;
  glm::dvec3 gradient_now(const glm::dvec3& position_m,
                          const hw::StickIndex& stick,
                          const glm::dvec3& gradient) const;
  glm::dvec3 outward(int surface, const glm::dvec3& normal) const;

  std::optional<SurfaceCrossing> first_of_still(const hw::Ray& ray,
                                                render::Span span,
                                                render::EdgeSign sign) const;
  // scanned_surfaces_moving.cpp
  std::optional<SurfaceCrossing> first_of_moving(const hw::Ray& ray,
                                                 const render::Span& span,
                                                 render::EdgeSign sign) const;
  void look(const hw::Ray& ray, double at_m, Spot& spot) const;
  double swept_m(const hw::Ray& ray, const Spot& spot, double length_m) const;
  double lapse_s(const hw::Ray& ray, const Spot& spot, double length_m) const;
  double leap_m(const hw::Ray& ray, const Spot& spot) const;
  std::optional<SurfaceCrossing> crossing(
      const hw::Ray& ray, int target, Spot before, Spot behind, render::EdgeSign sign) const;

  phantoms::Phantom phantom_;
  phantoms::Placement placement_;
  phantoms::Motion motion_;
  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  MotionBounds bounds_;
  phantoms::SurfaceFinder finder_;
  /// The phantom at the time of each stick, [frame * lines + line]; none for a still one.
  std::shared_ptr<const std::vector<phantoms::Deformation>> moments_;
};

}  // namespace wobblebench::bench
