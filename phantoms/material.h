// Acoustic materials.
#pragma once

#include <string>
#include <vector>

namespace wobblebench::phantoms {

/// One row of the material table.
struct Material {
  std::string name;
  double sound_speed_m_s = 1540;
  double impedance_rayl = 1.63e6;          ///< density times sound speed
  double attenuation_db_per_cm_mhz = 0.5;  ///< one way
  double backscatter_db = -200;  ///< mean echo amplitude against a perfect mirror; -200: none
  double roughness = 0;          ///< share of an interface's echo that is diffuse, 0 to 1
  std::string source;  ///< where the figures come from; "assumed" where they are not known
};

/// Position of a material in a phantom's table; the value of the material-index grid.
using MaterialIndex = int;

/// The built-in table (docs/references.md names the sources). Throws std::out_of_range for a name
/// that it does not hold, naming those that it does.
const std::vector<Material>& material_table();
const Material& material(const std::string& name);
/// Row of `name` in material_table().
MaterialIndex material_index(const std::string& name);

}  // namespace wobblebench::phantoms
