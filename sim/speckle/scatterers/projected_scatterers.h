// Scatterers within the beam of one stick, as a structure of arrays.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobblebench::sim {

/// One array for each property of the scatterers.
struct ProjectedScatterers {
  float* range_m;              ///< apparent range of the echo
  std::uint32_t* table_index;  ///< entries of the BeamTable: lateral in the low 16 bits, elevation
                               ///< in the high 16 bits
  float* amplitude;

  ProjectedScatterers from(std::size_t first) const {
    return {range_m + first, table_index + first, amplitude + first};
  }
};

}  // namespace wobblebench::sim
