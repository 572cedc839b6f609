// Where scatterers lie in tissue at rest: a lattice of hash cells with the same number in each. A
// cell's key says where, so that nothing is stored and everybody finds the same.
//
// Far from the beam's foci thousands of scatterers would fall into one resolution cell, where ten
// make the same speckle. They are therefore the sum of octaves: the first holds the density
// that the widest beam needs, each further one as much as all before it. A beam that is too wide
// for an octave fades it out, and the others become stronger, so that the mean echo stays what it
// is. The fade is slow, and depends on the range alone: tissue that moves, or is seen from another
// stick, keeps its speckle.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sim/random.h"

namespace wobblebench::sim {

/// In each cell: as many as a wide machine looks at together. Over a resolution cell or less that
/// is close to a Poisson process.
inline constexpr int kScatterersInCell = 8;

/// Offset in a cell in hash units: 2^11 of them along x and y, 2^10 along z.
struct CellOffset {
  float x;
  float y;
  float z;
};
inline constexpr double kHashUnits[3] = {2048, 2048, 1024};

/// The `index`-th scatterer of a cell, in the middle of its unit.
WOBBLEBENCH_INLINE CellOffset scatterer_offset(std::uint32_t key, std::uint32_t index) {
  const std::uint32_t bits = mix32(key + (index + 1) * 0x9e3779b9U);
  return {static_cast<float>(static_cast<std::int32_t>(bits & 2047)) + 0.5f,
          static_cast<float>(static_cast<std::int32_t>((bits >> 11) & 2047)) + 0.5f,
          static_cast<float>(static_cast<std::int32_t>(bits >> 22)) + 0.5f};
}

/// Key of one of a parcel's hash cells, counted with x fastest.
WOBBLEBENCH_INLINE std::uint32_t hash_cell_key(std::uint32_t parcel_key, std::uint32_t number) {
  return mix32(parcel_key + number * 0x85ebca6bU);
}

/// How many of a cell's flags are set; the library's way is a call without an instruction for it.
inline int flags_set(std::uint32_t flags) {
  static_assert(kScatterersInCell == 8);
  const std::uint32_t pairs = flags - (flags >> 1 & 0x55u);
  const std::uint32_t fours = (pairs & 0x33u) + (pairs >> 2 & 0x33u);
  return static_cast<int>((fours + (fours >> 4)) & 0x0fu);
}

/// Hash cells of one octave in a parcel, at most.
inline constexpr int kMostCells = 128;

/// One octave.
struct Octave {
  double per_m3;
  int divisions;  ///< hash cells along the side of a parcel
  std::uint64_t key;

  int cells() const { return divisions * divisions * divisions; }
  std::uint32_t parcel_key(const glm::ivec3& parcel) const;
};

/// All octaves, in parcels of tissue that each divides into its own hash cells.
struct ScattererCells {
  double parcel_m = 0;
  std::vector<Octave> octaves;

  /// Octaves that together have a density, for beams up to `widest` times as wide as the narrowest.
  ScattererCells(double per_m3, double widest, std::uint64_t seed);
};

/// Share of an octave's power that is left in a beam `width` times as wide as the narrowest. The
/// effective number of scatterers in the beam, (sum of powers)^2 / sum of squared powers, is never
/// less than in the narrowest beam. The first octave fades last, where the others are silent.
double octave_power(int octave, int octaves, double width);

/// What is left of the power of a cell's `scatterer`-th scatterer when its octave keeps a share:
/// they fall silent one after the other, so that no more are looked for than are needed.
double scatterer_power(double octave_power, int scatterer);

}  // namespace wobblebench::sim
