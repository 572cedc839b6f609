// Options of a phantom: which one, and its parameters.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::phantoms {

/// Options or a file that no phantom can be made of; what() is one line.
///
/// @code
/// #include <iostream>
/// try {
///   phantoms::validate(phantoms::PhantomOptions{.name = "sphere", .radius_m = 0});
/// } catch (const phantoms::InvalidPhantom& error) {
///   std::cerr << error.what();  // radius_mm = 0: must be within 1 and 100
/// }
/// @endcode
class InvalidPhantom : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

enum class Side { left, right };  ///< of the child

enum class HandPlace {
  beside,  ///< below the cheek, closed
  before,  ///< before the mouth and chin, fingers stretched
};

enum class CordPlace {
  beside,  ///< beside the face
  before,  ///< a loop across the face
};

/// Fields that the named phantom does not use are ignored, but checked.
struct PhantomOptions {
  std::string name = "fetal_face";  ///< a name of phantom_names(), or "mesh", "vdb", "file"
  /// mesh: an .obj, .stl or .ply; vdb: level sets of other programs; file: from write_phantom().
  std::string file;
  double voxel_m = 0.5e-3;            ///< for all but vdb and file, which state their own
  double gestational_age_weeks = 21;  ///< fetal_face
  /// fetal_face: which child. 0: the mean one of its age; any other number draws all measures of
  /// the face (phantoms/fetal/face_identity.h).
  std::uint64_t identity = 0;
  /// fetal_face: thickness of the mother's skin, fat and muscle between the probe's face and the
  /// uterine wall, on the axis of the probe. 0: the uterine wall reaches the probe.
  double maternal_layer_m = 18e-3;
  /// fetal_face: gap between the lips at rest. 0: closed, and cannot move.
  double mouth_open_m = 0;
  // fetal_face: pose of the head, about x, y and z in this order. Positive pitch: the forehead
  // comes forward, the chin goes to the chest.
  double head_pitch_rad = -4 * kDegree;
  double head_yaw_rad = 8 * kDegree;
  double head_roll_rad = -5 * kDegree;
  // fetal_face: expression.
  double smile_m = 0;      ///< by which the corners of the mouth are drawn up and aside
  double tongue_m = 0;     ///< length of the tongue before the lips; needs an open mouth
  double lids_open_m = 0;  ///< height of the opening between the lids
  // fetal_face: anomalies, as deviations from this child's own measures. 0: none.
  double cleft_width_m = 0;         ///< gap of the upper lip at its edge
  Side cleft_side = Side::left;     ///< of the child
  double cleft_alveolus_m = 0;      ///< width of the gap in the upper jaw behind it
  double chin_back_rad = 0;         ///< decrease of the inferior facial angle
  double jaw_shorter_m = 0;         ///< decrease of the mandible's length
  double nasal_bone_shorter_m = 0;  ///< decrease of its length; all of it: absent
  double eyes_apart_m = 0;          ///< increase of the distances of the orbits
  double bossing_m = 0;             ///< by which the forehead bulges
  double ears_lower_rad = 0;        ///< increase of the ear-eye angle
  // fetal_face: what lies before the face.
  HandPlace hand = HandPlace::beside;
  double hand_gap_m = 3e-3;  ///< least distance of a hand before the face from the skin
  CordPlace cord = CordPlace::beside;
  double cord_gap_m = 3e-3;  ///< least distance of a cord before the face from the skin
  double placenta_m = 0;     ///< thickness of an anterior placenta; 0: none there
  double radius_m = 20e-3;   ///< sphere, cyst
  /// steps: height of each tread above the one to its left.
  std::vector<double> step_heights_m = {1e-3, 2e-3, 3e-3, 5e-3, 8e-3};
  double thickness_m = 3e-3;   ///< bone_plate
  double point_echo_db = -50;  ///< points: of each, re a perfect mirror
  double tilt_x_rad = 0;       ///< plane, bone_plate: the normal is rotated about x …
  double tilt_y_rad = 0;       ///< … and about y

  // mesh and vdb; materials are names of material_table().
  double unit_m = 1e-3;                                  ///< length of the file's unit
  std::vector<std::string> grids;                        ///< vdb: in painter's order; none: all
  std::vector<std::string> materials = {"soft_tissue"};  ///< within each surface; one: within all
  std::string background = "amniotic_fluid";             ///< outside all surfaces; points too
  bool target = true;                ///< whether the renderer is to detect the surfaces …
  std::vector<std::string> targets;  ///< … vdb: of these grids; none: of all

  /// A .csv or .h5 of point scatterers beside any phantom's (phantoms/io/scatterer_file.h); empty:
  /// none.
  std::string scatterers;
  double scatterers_gain_db = 0;  ///< on their amplitudes
};

template <OptionsOf<PhantomOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.text("name", o.name);
  v.text("file", o.file);
  v.real("voxel_mm", o.voxel_m, kMillimetre, 0.1, 5);
  v.real("gestational_age_weeks", o.gestational_age_weeks, 1, 20, 34);
  v.seed("identity", o.identity);
  v.real("maternal_layer_mm", o.maternal_layer_m, kMillimetre, 0, 60);
  v.real("mouth_open_mm", o.mouth_open_m, kMillimetre, 0, 10);
  v.real("head_pitch_deg", o.head_pitch_rad, kDegree, -30, 30);
  v.real("head_yaw_deg", o.head_yaw_rad, kDegree, -40, 40);
  v.real("head_roll_deg", o.head_roll_rad, kDegree, -40, 40);
  v.real("smile_mm", o.smile_m, kMillimetre, 0, 3);
  v.real("tongue_mm", o.tongue_m, kMillimetre, 0, 6);
  v.real("lids_open_mm", o.lids_open_m, kMillimetre, 0, 4);
  v.real("cleft_width_mm", o.cleft_width_m, kMillimetre, 0, 8);
  v.choice("cleft_side", o.cleft_side, {{"left", Side::left}, {"right", Side::right}});
  v.real("cleft_alveolus_mm", o.cleft_alveolus_m, kMillimetre, 0, 8);
  v.real("chin_back_deg", o.chin_back_rad, kDegree, 0, 30);
  v.real("jaw_shorter_mm", o.jaw_shorter_m, kMillimetre, 0, 10);
  v.real("nasal_bone_shorter_mm", o.nasal_bone_shorter_m, kMillimetre, 0, 20);
  v.real("eyes_apart_mm", o.eyes_apart_m, kMillimetre, -5, 6);
  v.real("bossing_mm", o.bossing_m, kMillimetre, 0, 6);
  v.real("ears_lower_deg", o.ears_lower_rad, kDegree, 0, 15);
  v.choice("hand", o.hand, {{"beside", HandPlace::beside}, {"before", HandPlace::before}});
  v.real("hand_gap_mm", o.hand_gap_m, kMillimetre, 0, 10);
  v.choice("cord", o.cord, {{"beside", CordPlace::beside}, {"before", CordPlace::before}});
  v.real("cord_gap_mm", o.cord_gap_m, kMillimetre, 0, 10);
  v.real("placenta_mm", o.placenta_m, kMillimetre, 0, 35);
  v.real("radius_mm", o.radius_m, kMillimetre, 1, 100);
  v.reals("step_heights_mm", o.step_heights_m, kMillimetre, 0.1, 20);
  v.real("thickness_mm", o.thickness_m, kMillimetre, 0.5, 20);
  v.real("point_echo_db", o.point_echo_db, 1, -100, 0);
  v.real("tilt_x_deg", o.tilt_x_rad, kDegree, -60, 60);
  v.real("tilt_y_deg", o.tilt_y_rad, kDegree, -60, 60);
  v.real("unit_mm", o.unit_m, kMillimetre, 1e-3, 1e4);
  v.texts("grids", o.grids);
  v.texts("materials", o.materials);
  v.text("background", o.background);
  v.flag("target", o.target);
  v.texts("targets", o.targets);
  v.text("scatterers", o.scatterers);
  v.real("scatterers_gain_db", o.scatterers_gain_db, 1, -300, 300);
}

/// fetal_face, plane, steps, sphere, points, cyst, bone_plate, speckle_block.
const std::vector<std::string>& phantom_names();

/// Checks all that can be checked without building: ranges, names, the voxel size that the phantom
/// needs, a file that is missing or empty. Throws InvalidPhantom "KEY = VALUE: what is allowed".
void validate(const PhantomOptions& options);

}  // namespace wobblebench::phantoms
