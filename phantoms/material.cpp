#include "phantoms/material.h"

#include <stdexcept>

namespace wobblebench::phantoms {
namespace {

// Sound speed, impedance and attenuation: as `source` says. Backscatter and roughness are assumed
// throughout, chosen so that fluid is black, tissue grey, and skin brighter.
std::vector<Material> make_table() {
  constexpr double kMrayl = 1e6;
  const std::string assumed_echo = "; backscatter and roughness assumed";
  return {
      {"water", 1480, 1.48 * kMrayl, 0.0022, -200, 0, "tabulated; widely used in ray simulators"},
      {"amniotic_fluid",
       1530,
       1.51 * kMrayl,
       0.005,
       -200,
       0,
       "assumed water-like (no measured value found); the follicular fluid figure at 37 C is "
       "1550 +- 3 m/s (Gooding 2005)"},
      {"vitreous", 1530, 1.51 * kMrayl, 0.005, -200, 0, "assumed as amniotic fluid"},
      {"fetal_skin",
       1600,
       1.65 * kMrayl,
       0.35,
       -42,
       0.3,
       "assumed soft skin; adult skin is 1730 m/s and 1.99 MRayl at 0.35 (PMC10346919 table A2; "
       "PMC10001275 table 4)" +
           assumed_echo},
      {"skin",
       1730,
       1.99 * kMrayl,
       0.35,
       -42,
       0.3,
       "adult (PMC10346919 table A2; PMC10001275 table 4)" + assumed_echo},
      {"fat", 1450, 1.38 * kMrayl, 0.63, -48, 0.3, "tabulated" + assumed_echo},
      {"muscle", 1580, 1.70 * kMrayl, 1.09, -46, 0.3, "tabulated" + assumed_echo},
      {"soft_tissue",
       1540,
       1.63 * kMrayl,
       0.5,
       -45,
       0.3,
       "the textbook average tissue" + assumed_echo},
      {"uterus_wall",
       1540,
       1.66 * kMrayl,
       0.83,
       -43,
       0.3,
       "4.1-4.2 dB/cm at 5 MHz ex vivo (PMC3056396)" + assumed_echo},
      {"brain",
       1540,
       1.58 * kMrayl,
       0.4,
       -50,
       0.3,
       "assumed: fetal brain is softer and wetter than the average tissue" + assumed_echo},
      {"umbilical_cord",
       1560,
       1.62 * kMrayl,
       0.5,
       -44,
       0.3,
       "assumed: Wharton's jelly and vessels as a soft tissue" + assumed_echo},
      {"fetal_skull",
       2500,
       4.5 * kMrayl,
       5.0,
       -40,
       0.4,
       "assumed between soft tissue and adult cortical bone" + assumed_echo},
      {"cortical_bone",
       3432,
       6.5 * kMrayl,
       5.0,
       -40,
       0.4,
       "3432-4080 m/s, 6.5-7.8 MRayl, 1-15 dB/cm/MHz (PMC10346919; PMC10001275)" + assumed_echo},
      {"echogenic_fluid",
       1530,
       1.51 * kMrayl,
       0.005,
       -70,
       0,
       "assumed as amniotic fluid with particles" + assumed_echo},
      {"placenta",
       1540,
       1.63 * kMrayl,
       0.6,
       -43,
       0.3,
       "assumed between soft tissue and uterine wall" + assumed_echo},
  };
}

}  // namespace

const std::vector<Material>& material_table() {
  static const std::vector<Material> table = make_table();
  return table;
}

const Material& material(const std::string& name) {
  std::string known;
  for (const Material& entry : material_table()) {
    if (entry.name == name) return entry;
    known += (known.empty() ? "" : ", ") + entry.name;
  }
  throw std::out_of_range("material " + name + ": must be one of " + known);
}

MaterialIndex material_index(const std::string& name) {
  return MaterialIndex(&material(name) - material_table().data());
}

}  // namespace wobblebench::phantoms
