// Where scatterers lie in tissue at rest: a Poisson process on a lattice of hash cells. A cell's
// key says how many it holds and where, so that nothing is stored and everybody finds the same.
//
// Far from the beam's foci thousands of scatterers would fall into one resolution cell, where ten
// make the same speckle. The process is therefore the sum of octaves: the first holds the density
// that the widest beam needs, each further one as much as all before it. A beam that is too wide
// for an octave fades it out, and the others become stronger, so that the mean echo stays what it
// is. The fade is slow, and depends on the range alone: tissue that moves, or is seen from another
// stick, keeps its speckle.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sim/random.h"

namespace wobblebench::sim {

/// Number of scatterers in a cell, by the leading bits of the cell's key: Poisson with a given
/// mean. Its steps are 1/2048 of the probability; mean and variance keep within 0.5 %.
class PoissonCount {
 public:
  /// `mean` at most 64.
  explicit PoissonCount(double mean);
  int operator()(std::uint32_t key) const { return counts_[key >> (32 - kBits)]; }

 private:
  static constexpr int kBits = 11;
  std::array<std::uint8_t, 1 << kBits> counts_{};
};

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

/// One octave: a Poisson process of its own.
struct Octave {
  double per_m3;
  int divisions;  ///< hash cells along the side of a parcel
  std::uint64_t key;
  PoissonCount count;

  Octave(double density_per_m3, double parcel_m, std::uint64_t seed, int number);
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
/// less than in the narrowest beam.
double octave_power(int octave, int octaves, double width);

}  // namespace wobblebench::sim
