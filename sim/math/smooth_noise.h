// Smooth random fields: hashes at the nodes of a cubic lattice, interpolated between them.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

#include "sim/math/fast_math.h"
#include "sim/math/random.h"

namespace wobblebench::sim {

/// About normal, of unit variance, at most 3.46: the sum of the four bytes of a hash.
inline float bell(std::uint32_t bits) {
  constexpr float kMean = 510.0F, kSigma = 147.8F;
  const std::uint32_t pairs = (bits & 0x00ff00ffU) + ((bits >> 8) & 0x00ff00ffU);
  return (static_cast<float>((pairs & 0xffffU) + (pairs >> 16)) - kMean) / kSigma;
}

/// A field of zero mean and unit variance. `at`: in lattice spacings.
inline float smooth_noise(std::uint64_t key, const glm::dvec3& at) {
  const double low[] = {std::floor(at.x), std::floor(at.y), std::floor(at.z)};
  float weight[3][2];
  std::uint32_t node[3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto t = static_cast<float>(at[axis] - low[axis]);
    weight[axis][1] = t * t * (3.0F - 2.0F * t);
    weight[axis][0] = 1.0F - weight[axis][1];
    node[axis] = static_cast<std::uint32_t>(static_cast<std::int64_t>(low[axis]));
  }
  float sum = 0, squares = 0;
  for (std::uint32_t z = 0; z < 2; ++z) {
    const std::uint32_t of_z = mix32(node[2] + z + static_cast<std::uint32_t>(key));
    for (std::uint32_t y = 0; y < 2; ++y) {
      const std::uint32_t of_y =
          mix32((node[1] + y) * 0x85ebca6bU + of_z + static_cast<std::uint32_t>(key >> 32));
      for (std::uint32_t x = 0; x < 2; ++x) {
        const float share = weight[0][x] * weight[1][y] * weight[2][z];
        sum += share * bell(mix32((node[0] + x) * 0x9e3779b9U + of_y));
        squares += share * share;
      }
    }
  }
  return sum / std::sqrt(squares);
}

/// The amplitude factor of a level that varies by `sigma_db` about its mean power, which it keeps.
/// `normal`: a number of zero mean and unit variance.
inline float level_factor(double sigma_db, float normal) {
  const auto sigma = static_cast<float>(sigma_db * std::log(10.0) / 20);
  return fast_exp(sigma * normal - sigma * sigma);
}

}  // namespace wobblebench::sim
