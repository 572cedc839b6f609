// Options of a phantom: which one, and its parameters.
#pragma once

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

/// Fields that the named phantom does not use are ignored, but checked.
struct PhantomOptions {
  std::string name = "fetal_face";  ///< a name of phantom_names(), or "mesh", "vdb", "file"
  /// mesh: an .obj, .stl or .ply; vdb: level sets of other programs; file: from write_phantom().
  std::string file;
  double voxel_m = 0.5e-3;            ///< for all but vdb and file, which state their own
  double gestational_age_weeks = 21;  ///< fetal_face
  /// fetal_face: thickness of the mother's skin, fat and muscle between the probe's face and the
  /// uterine wall, on the axis of the probe. 0: the uterine wall reaches the probe.
  double maternal_layer_m = 18e-3;
  /// fetal_face: gap between the lips at rest. 0: closed, and cannot move.
  double mouth_open_m = 0;
  double radius_m = 20e-3;  ///< sphere, cyst
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
  v.real("gestational_age_weeks", o.gestational_age_weeks, 1, 20, 30);
  v.real("maternal_layer_mm", o.maternal_layer_m, kMillimetre, 0, 60);
  v.real("mouth_open_mm", o.mouth_open_m, kMillimetre, 0, 10);
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
