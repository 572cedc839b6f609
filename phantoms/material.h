// Acoustic materials and their built-in table.
#pragma once

#include <string>
#include <vector>

namespace wobblebench::phantoms {

/// One row of the material table.
///
/// @code
/// #include <iostream>
/// const phantoms::Material& fat = phantoms::material("fat");
/// const phantoms::Material& muscle = phantoms::material("muscle");
/// const double reflection = (muscle.impedance_rayl - fat.impedance_rayl) /
///                           (muscle.impedance_rayl + fat.impedance_rayl);
/// std::cout << reflection;  // amplitude, at normal incidence
/// @endcode
struct Material {
  std::string name;
  double sound_speed_m_s = 1540;
  double impedance_rayl = 1.63e6;          ///< density times sound speed
  double attenuation_db_per_cm_mhz = 0.5;  ///< one way
  double backscatter_db = -200;  ///< mean echo amplitude against a perfect mirror; -200: none
  double roughness = 0;          ///< diffuse fraction of an interface's echo, 0 to 1
  std::string source;            ///< origin of the figures; "assumed" where none are published
};

/// Row of a material in a phantom's table; the voxel value of the grid "material" of a .vdb.
using MaterialIndex = int;

/// The built-in table; docs/references.md lists the sources.
const std::vector<Material>& material_table();
/// Its row of this name. Throws std::out_of_range, naming all rows, if there is none.
const Material& material(const std::string& name);
/// Row of `name` in material_table().
MaterialIndex material_index(const std::string& name);

}  // namespace wobblebench::phantoms
