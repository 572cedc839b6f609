// Smooth random fields: hashes at the nodes of a cubic lattice, interpolated between them.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

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
  const glm::dvec3 low = {std::floor(at.x), std::floor(at.y), std::floor(at.z)};
  const glm::dvec3 t = at - low;
  const glm::dvec3 rise = t * t * (glm::dvec3(3) - 2.0 * t);
  double sum = 0, squares = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = (corner >> 1) & 1, z = corner >> 2;
    const double weight = (x == 1 ? rise.x : 1 - rise.x) * (y == 1 ? rise.y : 1 - rise.y) *
                          (z == 1 ? rise.z : 1 - rise.z);
    const auto node = [](double whole, int step) {
      return static_cast<std::uint32_t>(static_cast<std::int64_t>(whole) + step);
    };
    const std::uint32_t bits = mix32(node(low.x, x) * 0x9e3779b9U +
                                     mix32(node(low.y, y) * 0x85ebca6bU +
                                           mix32(node(low.z, z) + static_cast<std::uint32_t>(key)) +
                                           static_cast<std::uint32_t>(key >> 32)));
    sum += weight * static_cast<double>(bell(bits));
    squares += weight * weight;
  }
  return static_cast<float>(sum / std::sqrt(squares));
}

/// The amplitude factor of a level that varies by `sigma_db` about its mean power, which it keeps.
/// `normal`: a number of zero mean and unit variance.
inline float level_factor(double sigma_db, float normal) {
  const double sigma = sigma_db * std::log(10.0) / 20;
  return static_cast<float>(std::exp(sigma * static_cast<double>(normal) - sigma * sigma));
}

}  // namespace wobblebench::sim
