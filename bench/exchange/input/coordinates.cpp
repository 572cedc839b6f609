#include "bench/exchange/input/coordinates.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/number_text.h"
#include "base/units.h"
#include "base/user_error.h"

namespace wobblebench::bench {

namespace {

constexpr double kAllowedShare = 0.01;  // of a step

/// Voxels of a volume along each axis of the file, fastest first; 1 for an axis that it lacks.
std::array<std::uint64_t, 3> sizes_of(const VoxelFile& file, std::size_t voxels) {
  std::array<std::uint64_t, 3> sizes{1, 1, 1};
  std::uint64_t product = 1;
  for (std::size_t i = 0; i < 3 && product < voxels; ++i) {
    sizes.at(i) = file.sizes.at(i);
    product *= sizes.at(i);
  }
  return sizes;
}

}  // namespace

void place_by(const Coordinates& coordinates, VoxelFile& file) {
  const auto sizes = sizes_of(file, coordinates.size());
  const std::array<std::uint64_t, 3> strides{1, sizes[0], sizes[0] * sizes[1]};
  std::array<glm::dvec3, 3> step_m{};
  double least_m = HUGE_VAL;
  file.directions_mm.assign(file.sizes.size(), std::nullopt);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (sizes.at(axis) < 2) continue;
    const std::uint64_t steps = sizes.at(axis) - 1;
    step_m.at(axis) = (coordinates.at(steps * strides.at(axis)) - coordinates.front()) /
                      static_cast<double>(steps);
    least_m = std::min(least_m, glm::length(step_m.at(axis)));
    file.directions_mm.at(axis) = step_m.at(axis) / kMillimetre;
  }
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    glm::dvec3 expected = coordinates.front();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      expected += static_cast<double>(i / strides.at(axis) % sizes.at(axis)) * step_m.at(axis);
    }
    if (glm::distance(coordinates[i], expected) <= kAllowedShare * least_m) continue;
    throw UserError(file.path.string() + ": coordinate " + std::to_string(i) +
                    " is not that of a grid of equal steps; must be, with layout = \"cartesian\"");
  }
  file.origin_mm = coordinates.front() / kMillimetre;
}

void check_sticks(const Coordinates& coordinates,
                  const ForeignArray& array,
                  const hw::AcquisitionPlan& plan,
                  const std::vector<double>& motor_rad) {
  const hw::ProbeGeometry geometry = plan.geometry();
  std::vector<glm::dvec3> apart;
  apart.reserve(coordinates.size());
  glm::dvec3 mean(0);
  for (std::uint64_t frame = 0; frame < array.size(2); ++frame) {
    for (std::uint64_t line = 0; line < array.size(1); ++line) {
      const hw::Ray ray = geometry.stick(plan.theta_rad(static_cast<int>(line)), motor_rad[frame]);
      for (std::uint64_t k = 0; k < array.size(0); ++k) {
        const glm::dvec3 planned = ray.at(plan.sample_range_m(static_cast<int>(k)));
        apart.push_back(coordinates.at(array.index(k, line, frame)) - planned);
        mean += apart.back() / static_cast<double>(coordinates.size());
      }
    }
  }
  double most_m = 0;
  for (const glm::dvec3& one : apart) most_m = std::max(most_m, glm::distance(one, mean));
  const double allowed_m = plan.acquisition().depth_m / plan.acquisition().samples_per_stick;
  if (most_m <= allowed_m) return;
  throw UserError(array.file().path.string() + ": its coordinates lie up to " +
                  significant(most_m / kMillimetre, 3) +
                  " mm from where the geometry puts its samples; must be within " +
                  significant(allowed_m / kMillimetre, 3) + " mm");
}

void check_steps(const Coordinates& coordinates,
                 const ForeignArray& array,
                 const std::array<double, 2>& step_m) {
  const std::array<std::uint64_t, 2> next{array.index(1, 0, 0), array.index(0, 1, 0)};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (array.size(axis) < 2) continue;
    const double given_m =
        glm::distance(coordinates.at(next.at(axis)), coordinates.at(array.index(0, 0, 0)));
    if (std::abs(given_m - step_m.at(axis)) <= kAllowedShare * step_m.at(axis)) continue;
    throw UserError(array.file().path.string() + ": its coordinates step by " +
                    significant(given_m / kMillimetre, 4) +
                    " mm along an axis; geometry.spacing_mm says " +
                    significant(step_m.at(axis) / kMillimetre, 4));
  }
}

}  // namespace wobblebench::bench
