// The scanned tissue, and the line and the beam coordinates of each stick through it.
//
// Beam coordinates of a stick are axial (from the face), lateral (in the image plane) and elevation
// (across it), in metres.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/probe.h"
#include "phantoms/motion.h"
#include "phantoms/phantom.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

/// Ray and time of one stick.
struct TimedRay {
  hw::Ray ray;        ///< probe frame, from the face
  double time_s = 0;  ///< device time of the stick, at which moving tissue is sampled
};

/// Ray and time of a stick. `geometry`: plan.geometry(), computed once where many sticks are
/// needed.
TimedRay stick_ray(const hw::AcquisitionPlan& plan, const hw::StickIndex& index);
TimedRay stick_ray(const hw::AcquisitionPlan& plan,
                   const hw::ProbeGeometry& geometry,
                   const hw::StickIndex& index);

/// Unit vectors across a stick: in the image plane towards greater theta, and across the image
/// plane towards greater phi.
struct AcrossStick {
  glm::dvec3 lateral;
  glm::dvec3 elevation;
};
AcrossStick across_stick(const hw::Ray& ray);
/// Angle of the stick in its image plane.
double stick_angle_rad(const hw::Ray& ray);

/// A phantom as the probe scans it: tissue map, materials, placement before the probe, motion.
struct ScannedTissue {
  std::shared_ptr<const TissueMap> map;  ///< tissue at rest, phantom frame
  std::vector<phantoms::Material> materials;
  phantoms::Placement placement;
  phantoms::Motion motion;
  /// Point scatterers besides the tissue, in the phantom frame at rest; null: none.
  std::shared_ptr<const phantoms::PointScatterers> points = nullptr;

  bool has_points() const { return points && !points->empty(); }
  /// True if neither tissue nor point scatterers move.
  bool still() const { return motion.still() && (!points || points->all_fixed()); }

  /// From the probe frame at a time to the phantom frame at rest, and back.
  glm::dvec3 to_rest(const glm::dvec3& probe_m, double time_s) const {
    return motion.to_rest(placement.to_phantom(probe_m), time_s);
  }
  glm::dvec3 from_rest(const glm::dvec3& rest_m, double time_s) const {
    return placement.to_probe(motion.from_rest(rest_m, time_s));
  }
};

/// An affine map from the rest frame to beam coordinates.
struct RestToBeam {
  glm::dmat3 matrix{1.0};
  glm::dvec3 shift{0};

  glm::dvec3 operator()(const glm::dvec3& rest_m) const { return matrix * rest_m + shift; }
};

/// Transform between the rest frame of the tissue and the beam coordinates of one stick at its
/// time. Tissue may move non-rigidly; tissue that moves as one rigid body has one affine map.
class StickTransform {
 public:
  /// `tissue` must outlive it.
  StickTransform(const ScannedTissue& tissue, const TimedRay& line);

  /// From a position at rest to beam coordinates at the stick's time, and back.
  glm::dvec3 to_beam(const glm::dvec3& rest_m) const;
  glm::dvec3 to_rest(const glm::dvec3& beam_m) const;

  /// True if all tissue moves as one rigid body.
  bool rigid() const { return rigid_; }
  /// How tissue moves within a distance of a position at rest.
  phantoms::Deformation::Turn turn_within(const glm::dvec3& rest_m, double radius_m) const {
    return moment_.turn_within(rest_m, radius_m);
  }
  /// The map of tissue that moves as one rigid body: rests, or turns as a whole. Turn::none: that
  /// of all tissue, if rigid().
  const RestToBeam& rigid_map(phantoms::Deformation::Turn turn) const {
    return rigid_maps_[static_cast<std::size_t>(turn)];
  }
  /// First-order map around a position at rest.
  RestToBeam map_near(const glm::dvec3& rest_m) const;

 private:
  RestToBeam linearised(const phantoms::Deformation::Tangent& tangent,
                        const glm::dvec3& rest_m) const;

  const ScannedTissue& tissue_;
  hw::Ray ray_;
  AcrossStick across_;
  phantoms::Deformation moment_;
  bool rigid_;
  RestToBeam rigid_maps_[2];  ///< [Turn::none], [Turn::full]
};

}  // namespace wobblebench::sim
