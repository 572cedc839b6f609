// Positions of scatterers in tissue at rest: a uniform grid of hash cells with the same number of
// scatterers in each. A hash of the cell's key gives the positions, so that nothing is stored and
// every stick and thread gets the same.
//
// Away from the beam's foci thousands of scatterers would fall into one resolution cell, where ten
// give the same speckle statistics. Scatterers are therefore divided into octaves: the first has
// about the density that the largest resolution cell needs, and each further octave about the
// density of all octaves before it together. Where fewer scatterers are needed the last octaves do
// not contribute and the amplitudes of the others are increased, so that the mean echo is
// unchanged. The transition is gradual and depends on the range alone: tissue keeps its speckle
// when it moves or is seen from another stick.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sim/math/random.h"

namespace wobblebench::sim {

/// Scatterers in each hash cell. Over a resolution cell or less this is close to a Poisson process.
inline constexpr int kScatterersInCell = 16;

/// Position of a scatterer in its cell, in hash units from the cell's kHashOrigin. One hash of 32
/// bits serves all three axes: its low 11 bits, its low 22 bits, and all of it as a signed integer.
/// Each axis has 10 or 11 leading bits of its own, followed by the bits of the axis before.
struct CellOffset {
  float x;
  float y;
  float z;
};
/// Hash units along a cell's sides.
inline constexpr double kHashUnits[3] = {2048, 4194304, 4294967296};
/// As fractions of a cell's sides: x is at the middle of its unit, z is signed.
inline constexpr double kHashOrigin[3] = {0.5 / 2048, 0, 0.5};

WOBBLEBENCH_INLINE std::uint32_t scatterer_bits(std::uint32_t key, std::uint32_t index) {
  return mix32(key + (index + 1) * 0x9e3779b9U);
}

/// Sign of a scatterer's amplitude: +1 or -1, so that echoes have no coherent mean however short
/// the pulse is. Its bit is also the last one of x, less than a micrometre of tissue.
WOBBLEBENCH_INLINE float scatterer_sign(std::uint32_t bits) {
  return static_cast<float>(1 - 2 * static_cast<std::int32_t>(bits & 1u));
}

/// Offset of the `index`-th scatterer of a cell.
WOBBLEBENCH_INLINE CellOffset scatterer_offset(std::uint32_t bits) {
  return {static_cast<float>(static_cast<std::int32_t>(bits & 0x7ffu)),
          static_cast<float>(static_cast<std::int32_t>(bits & 0x3fffffu)),
          static_cast<float>(static_cast<std::int32_t>(bits))};
}

/// Position of the scatterer as fractions of the cell's sides, from its low corner.
inline glm::dvec3 scatterer_position(std::uint32_t key, std::uint32_t index) {
  const CellOffset at = scatterer_offset(scatterer_bits(key, index));
  return {kHashOrigin[0] + static_cast<double>(at.x) / kHashUnits[0],
          kHashOrigin[1] + static_cast<double>(at.y) / kHashUnits[1],
          kHashOrigin[2] + static_cast<double>(at.z) / kHashUnits[2]};
}

/// A hash cell's key is the mix32 of its seed. `number`: of the cell in its block, x fastest.
WOBBLEBENCH_INLINE std::uint32_t hash_cell_seed(std::uint32_t block_key, std::uint32_t number) {
  return block_key + number * 0x85ebca6bU;
}
inline std::uint32_t hash_cell_key(std::uint32_t block_key, std::uint32_t number) {
  return mix32(hash_cell_seed(block_key, number));
}

/// Coordinates of a hash cell's low corner in its block, in cells.
inline glm::dvec3 cell_coordinates(int number, int divisions) {
  return {number % divisions, number / divisions % divisions, number / (divisions * divisions)};
}

/// Number of set bits among the low 16; std::popcount is a call where there is no instruction.
inline int popcount16(std::uint32_t flags) {
  static_assert(kScatterersInCell <= 16);
  const std::uint32_t pairs = flags - (flags >> 1 & 0x5555u);
  const std::uint32_t fours = (pairs & 0x3333u) + (pairs >> 2 & 0x3333u);
  const std::uint32_t bytes = (fours + (fours >> 4)) & 0x0f0fu;
  return static_cast<int>((bytes + (bytes >> 8)) & 0x1fu);
}

/// Upper bound of the hash cells of one octave in a block.
inline constexpr int kMaxCells = 224;

struct Octave {
  double per_m3;
  int divisions;  ///< hash cells along the side of a block
  std::uint64_t key;

  int cells() const { return divisions * divisions * divisions; }
  std::uint32_t block_key(const glm::ivec3& block) const;
};

/// All octaves. They divide the same blocks of tissue into hash cells of different sizes.
struct ScattererCells {
  double block_m = 0;  ///< side of a block
  std::vector<Octave> octaves;

  /// Octaves of the given total density, for resolution cells up to `largest` times as large as the
  /// smallest.
  ScattererCells(double per_m3, double largest, std::uint64_t seed);

  /// Share of an octave's scatterers that contribute where a density of `per_m3` is needed: 1 for
  /// the first octaves, a fraction for the next, 0 for the others.
  double share(int octave, double per_m3) const;
};

/// Relative power of a cell's `scatterer`-th scatterer when `share` of its octave contributes: 1
/// for the first scatterers, a fraction for the next, 0 for the others, which are then not
/// computed. A cell's effective number of scatterers, (sum of powers)^2 / sum of squared powers, is
/// at least that share of them.
double scatterer_power(double share, int scatterer);

}  // namespace wobblebench::sim
