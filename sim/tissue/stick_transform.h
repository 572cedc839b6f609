// Transforms between the tissue's rest frame and the beam coordinates of one stick: axial (from the
// face), lateral, elevation, in metres.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "phantoms/motion.h"
#include "sim/tissue/timed_ray.h"

namespace wobblebench::sim {

struct ScannedTissue;

/// An affine map from the rest frame to beam coordinates.
struct RestToBeam {
  glm::dmat3 matrix{1.0};
  glm::dvec3 shift{0};

  glm::dvec3 operator()(const glm::dvec3& rest_m) const { return matrix * rest_m + shift; }
};

/// Tissue may move non-rigidly; whatever moves as one rigid body has one affine map.
class StickTransform {
 public:
  /// `tissue` must outlive it.
  StickTransform(const ScannedTissue& tissue, const TimedRay& line);

  /// From a position at rest to beam coordinates at the stick's time, and back.
  glm::dvec3 to_beam(const glm::dvec3& rest_m) const;
  glm::dvec3 to_rest(const glm::dvec3& beam_m) const;

  /// True if all tissue moves as one rigid body.
  bool rigid() const { return rigid_; }
  /// The map of all tissue, if rigid().
  const RestToBeam& map() const { return rigid_maps_[0]; }
  /// How tissue moves within a distance of a position at rest.
  phantoms::Deformation::Turn turn_within(const glm::dvec3& rest_m, double radius_m) const {
    return moment_.turn_within(rest_m, radius_m);
  }
  /// The map of tissue that moves as one rigid body: rests, or turns as a whole.
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
