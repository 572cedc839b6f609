// Where scatterers lie in tissue at rest: a lattice of hash cells with the same number in each. A
// cell's key says where, so that nothing is stored and everybody finds the same.
//
// Far from the beam's foci thousands of scatterers would fall into one resolution cell, where ten
// make the same speckle. They are therefore the sum of octaves: the first holds about the density
// that the largest resolution cell needs, each further one about as much as all before it. Where
// fewer are needed the last octaves fall silent, and the others become stronger, so that the mean
// echo stays what it is. The fade is slow, and depends on the range alone: tissue that moves, or is
// seen from another stick, keeps its speckle.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sim/math/random.h"

namespace wobblebench::sim {

/// In each cell. Over a resolution cell or less that is close to a Poisson process.
inline constexpr int kScatterersInCell = 16;

/// Where a scatterer lies in its cell, in hash units from the cell's kHashOrigin. The digits of one
/// hash are used where they are: what is the whole of x is behind the point of y, and so on.
struct CellOffset {
  float x;
  float y;
  float z;
};
/// Along a cell's sides.
inline constexpr double kHashUnits[3] = {2048, 4194304, 4294967296};
/// As shares of a cell's sides: places are in the middle of their units, and z counts from there.
inline constexpr double kHashOrigin[3] = {0.5 / 2048, 0, 0.5};

/// The `index`-th scatterer of a cell.
WOBBLEBENCH_INLINE CellOffset scatterer_offset(std::uint32_t key, std::uint32_t index) {
  const std::uint32_t bits = mix32(key + (index + 1) * 0x9e3779b9U);
  return {static_cast<float>(static_cast<std::int32_t>(bits & 0x7ffu)),
          static_cast<float>(static_cast<std::int32_t>(bits & 0x3fffffu)),
          static_cast<float>(static_cast<std::int32_t>(bits))};
}

/// The same as shares of the cell's sides.
inline glm::dvec3 scatterer_place(std::uint32_t key, std::uint32_t index) {
  const CellOffset at = scatterer_offset(key, index);
  return {kHashOrigin[0] + static_cast<double>(at.x) / kHashUnits[0],
          kHashOrigin[1] + static_cast<double>(at.y) / kHashUnits[1],
          kHashOrigin[2] + static_cast<double>(at.z) / kHashUnits[2]};
}

/// Key of one of a parcel's hash cells, counted with x fastest: the mix32 of its seed.
WOBBLEBENCH_INLINE std::uint32_t hash_cell_seed(std::uint32_t parcel_key, std::uint32_t number) {
  return parcel_key + number * 0x85ebca6bU;
}
inline std::uint32_t hash_cell_key(std::uint32_t parcel_key, std::uint32_t number) {
  return mix32(hash_cell_seed(parcel_key, number));
}

/// How many of 16 flags are set; the library's way is a call without an instruction for it.
inline int flags_set(std::uint32_t flags) {
  static_assert(kScatterersInCell <= 16);
  const std::uint32_t pairs = flags - (flags >> 1 & 0x5555u);
  const std::uint32_t fours = (pairs & 0x3333u) + (pairs >> 2 & 0x3333u);
  const std::uint32_t bytes = (fours + (fours >> 4)) & 0x0f0fu;
  return static_cast<int>((bytes + (bytes >> 8)) & 0x1fu);
}

/// Hash cells of one octave in a parcel, at most.
inline constexpr int kMostCells = 224;

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

  /// Octaves that together have a density, for resolution cells up to `largest` times as large as
  /// the smallest.
  ScattererCells(double per_m3, double largest, std::uint64_t seed);

  /// Share of an octave's scatterers that are heard where so many of all are needed: the first
  /// octaves are heard as a whole, one in part, the others not at all.
  double share(int octave, double per_m3) const;
};

/// Power of a cell's `scatterer`-th scatterer when a share of its octave is heard: they fall silent
/// one after the other, so that no more are looked for than are needed. The effective number of a
/// cell, (sum of powers)^2 / sum of squared powers, is no less than that share of them.
double scatterer_power(double share, int scatterer);

}  // namespace wobblebench::sim
