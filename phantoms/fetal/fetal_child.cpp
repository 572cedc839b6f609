#include "phantoms/fetal/fetal_child.h"

#include <string>

#include "base/units.h"

namespace wobblebench::phantoms {
namespace {

// Anomalies that are other values of the measures.
void deviate(FaceMeasures& measures, const PhantomOptions& options) {
  measures[FaceMeasure::inferior_facial_angle] -= options.chin_back_rad / kDegree;
  measures[FaceMeasure::mandible] -= options.jaw_shorter_m / kMillimetre;
  measures[FaceMeasure::nasal_bone] -= options.nasal_bone_shorter_m / kMillimetre;
  // Both move with the globes: the face is no wider.
  measures[FaceMeasure::interocular] += options.eyes_apart_m / kMillimetre;
  measures[FaceMeasure::binocular] += options.eyes_apart_m / kMillimetre;
  measures[FaceMeasure::ear_eye_angle] += options.ears_lower_rad / kDegree;
}

bool has_expression_or_cleft(const PhantomOptions& options) {
  return options.mouth_open_m > 0 || options.smile_m > 0 || options.lids_open_m > 0 ||
         options.cleft_width_m > 0 || options.bossing_m > 0;
}

// The solved face again, with expression and cleft; chin and lower lip lower where it is open.
void vary(SolvedHead& solved, const PhantomOptions& options) {
  HeadShape& shape = solved.shape;
  const auto units = [&](double metres) { return metres / shape.unit_m; };
  shape.open = units(options.mouth_open_m);
  shape.menton += shape.open;
  shape.smile = units(options.smile_m);
  shape.tongue = units(options.tongue_m);
  shape.lids_open = units(options.lids_open_m);
  shape.cleft_width = units(options.cleft_width_m);
  shape.cleft_side = options.cleft_side == Side::left ? 1 : -1;
  shape.cleft_alveolus = units(options.cleft_alveolus_m);
  shape.bossing = units(options.bossing_m);
  const FetalLandmarks closed = solved.measured.landmarks;
  solved.head = build_head(shape);
  solved.measured = measure_head(solved.head, shape);
  FetalLandmarks& found = solved.measured.landmarks;
  found.upper_lip_m = closed.upper_lip_m;
  found.mouth_m = closed.mouth_m + glm::dvec3(0, 0.5 * options.mouth_open_m, 0);
}

void pose(FetalLandmarks& landmarks, const PhantomOptions& options, double unit_m) {
  landmarks.head_to_phantom =
      rotation_xyz({options.head_pitch_rad, options.head_yaw_rad, options.head_roll_rad});
  landmarks.head_position_m = unit_m * glm::dvec3(0, -5, 2);
}

}  // namespace

FetalChild make_child(const PhantomOptions& options) {
  FaceIdentity identity = draw_identity(options.identity, options.gestational_age_weeks);
  const double own_bone = identity.measures[FaceMeasure::nasal_bone];
  deviate(identity.measures, options);
  double& bone = identity.measures[FaceMeasure::nasal_bone];
  double& ratio = identity.measures[FaceMeasure::prenasal_ratio];
  // Shorter than its round ends it is absent: the face is fitted with it, and it is left out.
  constexpr double kShortestBone_mm = 1.5;
  const bool absent = bone < kShortestBone_mm;
  if (absent) bone = own_bone;
  ratio *= own_bone / bone;  // the skin stays where it was
  FetalChild child;
  try {
    child.solved = solve_head(identity);
  } catch (const InvalidPhantom& error) {
    throw InvalidPhantom("identity = " + std::to_string(options.identity) + ": " + error.what());
  }
  child.targets = identity.measures;
  if (absent) {
    child.solved.shape.nasal_bone = 0;
    child.targets[FaceMeasure::nasal_bone] = child.targets[FaceMeasure::prenasal_ratio] = 0;
  }
  if (absent || has_expression_or_cleft(options)) vary(child.solved, options);
  pose(child.solved.measured.landmarks,
       options,
       face_unit_m(mean_face(options.gestational_age_weeks)));
  child.solved.head.landmarks = child.solved.measured.landmarks;
  return child;
}

std::vector<PhantomMeasure> measures_of(const FetalChild& child) {
  std::vector<PhantomMeasure> measures;
  const MeasuredHead& measured = child.solved.measured;
  for (std::size_t i = 0; i < kFaceMeasures; ++i) {
    measures.push_back({std::string(face_measure_laws()[i].name),
                        measured.measures.values[i],
                        child.targets.values[i]});
  }
  for (const NamedMeasure& other : measured.others) {
    measures.push_back({std::string(other.name), other.value, std::nullopt});
  }
  return measures;
}

FetalLandmarks fetal_landmarks(double gestational_age_weeks, double mouth_open_m) {
  return make_child({.gestational_age_weeks = gestational_age_weeks, .mouth_open_m = mouth_open_m})
      .solved.head.landmarks;
}

}  // namespace wobblebench::phantoms
