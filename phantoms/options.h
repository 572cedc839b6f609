// What a scene may ask of a phantom.
#pragma once

#include <string>
#include <vector>

#include "base/options.h"
#include "base/units.h"
#include "phantoms/invalid_phantom.h"

namespace wobblebench::phantoms {

/// Only the fields that the named phantom uses count.
struct PhantomOptions {
  std::string name = "fetal_face";  ///< a name of phantom_names(), or "mesh", "vdb", "file"
  /// mesh: an .obj, .stl or .ply; vdb: level sets of other programs; file: what write_phantom
  /// wrote.
  std::string file;
  double voxel_m = 0.5e-3;            ///< all but vdb and file, which have their own
  double gestational_age_weeks = 21;  ///< fetal_face
  /// fetal_face: the mother's skin, fat and muscle between the probe's face and the uterine wall,
  /// on the axis of the probe. 0: the uterine wall reaches the probe.
  double maternal_layer_m = 18e-3;
  double radius_m = 20e-3;  ///< sphere, cyst
  /// steps: how much each tread stands out before the one to its left.
  std::vector<double> step_heights_m = {1e-3, 2e-3, 3e-3, 5e-3, 8e-3};
  double thickness_m = 3e-3;  ///< bone_plate
  double tilt_x_rad = 0;      ///< plane, bone_plate: the normal turned about x …
  double tilt_y_rad = 0;      ///< … and about y

  // mesh and vdb; materials are names of material_table().
  double unit_m = 1e-3;                                  ///< length of the file's unit
  std::vector<std::string> grids;                        ///< vdb: in painter's order; none: all
  std::vector<std::string> materials = {"soft_tissue"};  ///< within each surface; one: within all
  std::string background = "amniotic_fluid";             ///< outside all surfaces
  bool target = true;                ///< whether the renderer looks for these surfaces …
  std::vector<std::string> targets;  ///< … vdb: for which of the grids; none: all
};

template <OptionsOf<PhantomOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.text("name", o.name);
  v.text("file", o.file);
  v.real("voxel_mm", o.voxel_m, kMillimetre, 0.1, 5);
  v.real("gestational_age_weeks", o.gestational_age_weeks, 1, 20, 30);
  v.real("maternal_layer_mm", o.maternal_layer_m, kMillimetre, 0, 60);
  v.real("radius_mm", o.radius_m, kMillimetre, 1, 100);
  v.reals("step_heights_mm", o.step_heights_m, kMillimetre, 0.1, 20);
  v.real("thickness_mm", o.thickness_m, kMillimetre, 0.5, 20);
  v.real("tilt_x_deg", o.tilt_x_rad, kDegree, -60, 60);
  v.real("tilt_y_deg", o.tilt_y_rad, kDegree, -60, 60);
  v.real("unit_mm", o.unit_m, kMillimetre, 1e-3, 1e4);
  v.texts("grids", o.grids);
  v.texts("materials", o.materials);
  v.text("background", o.background);
  v.flag("target", o.target);
  v.texts("targets", o.targets);
}

/// fetal_face, plane, steps, sphere, points, cyst, bone_plate, speckle_block.
const std::vector<std::string>& phantom_names();

/// Finds out all that can be known without building: ranges, names, the voxels that the phantom
/// needs, a file that is missing or empty. Throws InvalidPhantom "KEY = VALUE: what is allowed".
void validate(const PhantomOptions& options);

}  // namespace wobblebench::phantoms
