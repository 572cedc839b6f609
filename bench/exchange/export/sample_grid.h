// Grid points of equal spacing around a scan, and the samples at them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

/// Grid points of equal spacing in a box of the probe frame.
struct SampleGrid {
  glm::dvec3 low_m{0};  ///< the first point
  double spacing_m = 1;
  glm::ivec3 size{1};

  glm::dvec3 point_m(int x, int y, int z) const { return low_m + spacing_m * glm::dvec3(x, y, z); }
  std::vector<std::uint64_t> sizes() const {
    return {static_cast<std::uint64_t>(size.x),
            static_cast<std::uint64_t>(size.y),
            static_cast<std::uint64_t>(size.z)};
  }
  double voxels() const { return double{1} * size.x * size.y * size.z; }
};

/// Around all samples, with points at whole multiples of the spacing.
SampleGrid grid_around(const hw::AcquisitionPlan& plan, double spacing_m);

/// Samples of 0 to 1 as whole numbers from 0 to the type's largest.
template <class T>
std::vector<T> whole_numbers(std::span<const float> samples) {
  constexpr double kMost = std::numeric_limits<T>::max();
  std::vector<T> values(samples.size());
  std::ranges::transform(samples, values.begin(), [](float sample) {
    return static_cast<T>(std::lround(kMost * std::clamp<double>(sample, 0, 1)));
  });
  return values;
}

}  // namespace wobblebench::bench
