// The surfaces of a phantom as one volume of a scan images them: each point of space at the time of
// the stick that images it. Tissue that moves during the volume is sheared, and so is the truth.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/motion.h"
#include "phantoms/phantom.h"
#include "phantoms/placed_phantom.h"
#include "phantoms/truth.h"
#include "render/view.h"

namespace wobblebench::bench {

/// Bounds of a phantom's motion: sampled in space and time, with a margin for motion between the
/// samples; of a mouth in closed form.
struct MotionBounds {
  double speed_m_s = 0;   ///< of the position at rest of a fixed point
  double stretch = 1;     ///< distance at rest over the distance now of two points
  phantoms::Box at_rest;  ///< holds the positions at rest of all points of the box
};

struct SurfaceCrossing {
  double distance_m = 0;  ///< along the ray from its origin
  glm::dvec3 outward{0};  ///< unit, out of the tissue
  int surface = 0;        ///< index into Phantom::surfaces()
};

/// Materials whose echo is above this level are tissue, those below are fluid.
inline constexpr double kTissueBackscatter_db = -100;

/// The target surfaces in the probe frame, in one volume of the plan, within the view's box.
/// Threads must not share one: each takes a copy.
class ScannedSurfaces {
 public:
  /// `reach_m`: distance() is defined at least this near a surface.
  ScannedSurfaces(const phantoms::PlacedPhantom& subject,
                  const hw::AcquisitionPlan& plan,
                  const render::View& view,
                  double reach_m = 0,
                  std::uint32_t volume = 0);

  /// First crossing within the box, from fluid into tissue (rising edge) or from tissue into fluid
  /// (falling). Exact (OpenVDB's level-set intersector) for a still phantom. For a moving one the
  /// time is that of the nearest stick, so that a surface may have steps between sticks.
  std::optional<SurfaceCrossing> first(const hw::Ray& ray) const;

  /// The stick that images a position: nearest frame and line.
  hw::StickIndex stick_at(const glm::dvec3& position_m) const;

  /// The position at rest of what a stick images there.
  glm::dvec3 to_rest(const glm::dvec3& position_m, const hw::StickIndex& stick) const;

  /// Signed distance to a surface (negative inside) at the time of a stick, and its gradient; none
  /// beyond reach.
  std::optional<phantoms::SurfaceFinder::Distance> distance(const glm::dvec3& position_m,
                                                            const hw::StickIndex& stick) const;

 private:
  /// A point on a ray with its distances to the targets.
  struct RaySample {
    double at_m = 0;
    hw::StickIndex stick;
    glm::dvec3 rest_m{0};
    std::vector<double> distance_m;  ///< to each target, as distance_bound() gives it
  };

  /// Of a phantom that moves.
  const phantoms::Deformation& moment_of(const hw::StickIndex& stick) const;
  glm::dvec3 gradient_at_stick(const glm::dvec3& position_m,
                               const hw::StickIndex& stick,
                               const glm::dvec3& gradient) const;
  glm::dvec3 outward(int surface, const glm::dvec3& normal) const;

  std::optional<SurfaceCrossing> first_of_still(const hw::Ray& ray, render::Span span) const;
  std::optional<SurfaceCrossing> first_of_moving(const hw::Ray& ray,
                                                 const render::Span& span) const;
  void sample(const hw::Ray& ray, double at_m, RaySample& sample) const;
  double rest_displacement_m(const hw::Ray& ray, const RaySample& from, double step_m) const;
  double time_difference_s(const hw::Ray& ray, const RaySample& from, double step_m) const;
  double safe_step_m(const hw::Ray& ray, const RaySample& from) const;
  std::optional<SurfaceCrossing> crossing(const hw::Ray& ray,
                                          int target,
                                          RaySample before,
                                          RaySample behind) const;

  std::uint32_t volume_;
  phantoms::PlacedPhantom subject_;
  hw::AcquisitionPlan plan_;
  hw::ProbeGeometry geometry_;
  render::VolumeOfInterest box_;
  render::EdgeSign edge_;
  MotionBounds bounds_;
  phantoms::SurfaceFinder finder_;
  /// The motion at the time of each stick, [frame * lines + line]; empty for a still phantom.
  std::shared_ptr<const std::vector<phantoms::Deformation>> moments_;
};

}  // namespace wobblebench::bench
