// The fetal head: its shape by parameters, which solve_head() fits to the measures of an identity,
// and landmarks for caliper measurements. Head frame: metres, origin between the eyes on the face,
// x to the right of an observer facing it, y towards the chin, z towards the occiput.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "phantoms/fetal/face_identity.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

/// Points of the face in the head frame, metres, and the pose of that frame in the phantom: phantom
/// = head_to_phantom * head + head_position_m. The points lie within half a millimetre of the
/// grids' surfaces: they say where to measure, and replace no measurement.
struct FetalLandmarks {
  glm::dmat3 head_to_phantom{1.0};
  glm::dvec3 head_position_m{0};
  glm::dvec3 skull_center_m{0};  ///< the BPD/OFD plane is y = skull_center_m.y
  glm::dvec3 crown_m{0};         ///< highest point of the scalp
  glm::dvec3 eye_center_m{0};    ///< of the eye at +x; the other is about its mirror image
  glm::dvec3 nose_tip_m{0};
  glm::dvec3 subnasale_m{0};  ///< deepest point of the profile between nose and lip
  glm::dvec3 upper_lip_m{0};  ///< its most prominent point
  glm::dvec3 mouth_m{0};      ///< where the lips meet; open: middle of the gap
  glm::dvec3 lower_lip_m{0};  ///< its most prominent point
  glm::dvec3 menton_m{0};     ///< lowest point of the chin
};

/// What the head is built from. Lengths in units of `unit_m`, which is 1 mm in the mean face of 21
/// weeks and grows with the face; heights downwards from the origin.
struct HeadShape {
  double unit_m = 1e-3;
  double biparietal = 51.7;
  double occipitofrontal = 65.4;
  double forehead = -0.7;  ///< shift of the braincase forwards
  double interocular = 13;
  double binocular = 35.4;
  double subnasale = 10.0, upper_lip = 14.8, menton = 27.6;  ///< heights
  double nose = 1.4;                                         ///< shift of the tip forwards
  double chin = -0.2;                                        ///< shift of the chin backwards
  double bridge = 0.3;       ///< shift of the root of the nose forwards
  double bone_bridge = 0;    ///< shift of the bone under it forwards
  double nasal_bone = 7;     ///< length
  double zygoma = 18.6;      ///< half width
  double cheek = 9.4;        ///< of its centre, to the side
  double gonion = 22;        ///< depth
  double ear = 0.9;          ///< size
  double ear_height = -0.4;  ///< shift downwards
  // Expression.
  double open = 0;       ///< gap between the lips
  double smile = 0;      ///< shift of the corners of the mouth, upwards and half as far aside
  double tongue = 0;     ///< length of the tongue before the lips
  double lids_open = 0;  ///< height of the opening between the lids
  // Anomalies that are no measures of every face.
  double cleft_width = 0;     ///< gap in the edge of the upper lip
  double cleft_side = 1;      ///< its side: +1: the child's left, at +x; -1: its right
  double cleft_alveolus = 0;  ///< gap in the upper jaw
  double bossing = 0;         ///< height of the bulge of the forehead
  FaceTraits traits;
  Asymmetry asymmetry{};

  double mouth() const { return upper_lip + 2.1; }
  glm::dvec3 cleft() const;  ///< a point within the cleft of the lip's edge
  double lower_lip() const { return upper_lip + 4.4 + open; }
};

/// The head as CSG bodies, in the head frame.
struct FetalHead {
  CsgBody skin;
  CsgBody skull;               ///< outer surface of the bone, face bones included but the nasal one
  CsgBody nasal_bone;          ///< empty: absent
  glm::dvec3 nasal_root_m{0};  ///< its upper end …
  glm::dvec3 nasal_along{0};   ///< … and unit vector to its lower end
  CsgBody brain;               ///< inner surface of the braincase
  Ellipsoid eyes[2];           ///< globes filling the orbits, at -x and +x
  // Points before the skin at -x and +x, within the grooves: ends of the openings between the lids
  // next to the nose and away from it, and of the line between the lips.
  glm::dvec3 inner_corner_m[2]{};
  glm::dvec3 outer_corner_m[2]{};
  glm::dvec3 mouth_corner_m[2]{};
  FetalLandmarks landmarks;  ///< of the bodies whose shape says where they are: skull, crown, eye
};

FetalHead build_head(const HeadShape& shape);

/// Landmarks of the mean child's phantom of this age, in its default pose.
FetalLandmarks fetal_landmarks(double gestational_age_weeks, double mouth_open_m = 0);

}  // namespace wobblebench::phantoms
