// Landmarks of the fetal face, for caliper measurements.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace wobblebench::phantoms {

/// Points in the head frame (phantoms/fetal/fetal_head.h), metres, and the pose of that frame in
/// the phantom: phantom = head_to_phantom * head + head_position_m. Within half a millimetre of the
/// grids' surfaces: they say where to measure, and replace no measurement.
struct FetalLandmarks {
  glm::dmat3 head_to_phantom{1.0};
  glm::dvec3 head_position_m{0};
  glm::dvec3 skull_center_m{0};  ///< the BPD/OFD plane is y = skull_center_m.y
  glm::dvec3 crown_m{0};         ///< highest point of the scalp
  glm::dvec3 eye_center_m{0};    ///< of the eye at +x; the other is its mirror image
  glm::dvec3 nose_tip_m{0};
  glm::dvec3 subnasale_m{0};  ///< deepest point of the profile between nose and lip
  glm::dvec3 upper_lip_m{0};  ///< its most prominent point
  glm::dvec3 mouth_m{0};      ///< where the lips meet; open: middle of the gap
  glm::dvec3 lower_lip_m{0};  ///< its most prominent point
  glm::dvec3 menton_m{0};     ///< lowest point of the chin
};

/// Landmarks of the fetal_face phantom of this age.
FetalLandmarks fetal_landmarks(double gestational_age_weeks, double mouth_open_m = 0);

}  // namespace wobblebench::phantoms
