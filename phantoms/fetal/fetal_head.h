// The fetal head: its mean size by gestational age, its shape, and landmarks for caliper
// measurements. Head frame: metres, origin between the eyes on the face, x to the right of an
// observer facing it, y towards the chin, z towards the occiput.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

/// Means by gestational age, in metres.
struct FetalBiometry {
  double biparietal_m;       ///< BPD, outer to outer surface of the skull
  double head_around_m;      ///< HC, around the skull's outer surface in the BPD/OFD plane
  double occipitofrontal_m;  ///< OFD of the ellipse that has this BPD and HC
  double interocular_m;      ///< between the inner edges of the two orbits
  double binocular_m;        ///< between the outer edges of the two orbits
  double philtrum_m;         ///< base of the columella to the tip of the upper lip
  double chin_m;             ///< tip of the lower lip to the skin under the tip of the mandible
};

/// HC and BPD: INTERGROWTH-21st (Papageorghiou, Lancet 2014). Interocular and binocular distance:
/// Sukonpan 2008. Philtrum and chin: Gull, Fetal Diagn Ther 2005;20:127. OFD follows from BPD and
/// HC, so that the three agree exactly; the published OFD agrees with it within some millimetres.
/// Valid for 20 to 30 weeks, fractions included.
FetalBiometry fetal_biometry(double gestational_age_weeks);

/// Perimeter of the ellipse with these two diameters (Ramanujan 1914; within 1e-9 here).
double ellipse_perimeter(double diameter_a, double diameter_b);

/// Points of the face in the head frame, metres, and the pose of that frame in the phantom: phantom
/// = head_to_phantom * head + head_position_m. The points lie within half a millimetre of the
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

/// The head as CSG bodies, in the head frame.
struct FetalHead {
  CsgBody skin;
  CsgBody skull;      ///< outer surface of the bone, face bones included
  CsgBody brain;      ///< inner surface of the braincase
  Ellipsoid eyes[2];  ///< globes filling the orbits, at -x and +x
  FetalLandmarks landmarks;
};

/// The head of the given biometry. Lip and chin heights are solved for iteratively, so that the
/// extremes of the finished profile are apart by the philtrum and chin length of `biometry`.
/// `mouth_open_m`: gap between the lips; the lower jaw of the closed mouth's head is that much
/// lower.
FetalHead make_head(const FetalBiometry& biometry, double mouth_open_m);

}  // namespace wobblebench::phantoms
