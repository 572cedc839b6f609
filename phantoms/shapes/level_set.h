// Level sets sampled from signed-distance functions.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "phantoms/shapes/shapes.h"

namespace wobblebench::phantoms {

/// Signed distance in metres, negative inside; must be safe to call from several threads.
using DistanceFunction = std::function<double(const glm::dvec3&)>;

/// The same distances to the bit at every position in a ball, faster; for shapes of many parts,
/// most of which are far away. Must be safe to call from several threads.
using LocalDistance = std::function<DistanceFunction(const Ball&)>;

/// Half width of the narrow bands, in voxels.
inline constexpr int kHalfWidthVoxels = 4;

enum class Distances {
  exact,       ///< the function is a distance: its values are kept
  first_order  ///< zero on the surface only: |gradient| = 1 is solved for in the band
};

/// The narrow-band level set of the surface within `bounds`, which must contain the surface, or cut
/// it outside every field of view. The function is evaluated near its surface only; the grid's
/// bytes do not depend on the number of threads.
[[nodiscard]] std::shared_ptr<FloatGrid> build_level_set(const std::string& name,
                                                         const DistanceFunction& distance,
                                                         const Box& bounds,
                                                         double voxel_m,
                                                         Distances distances);
[[nodiscard]] std::shared_ptr<FloatGrid> build_level_set(const std::string& name,
                                                         const LocalDistance& distance,
                                                         const Box& bounds,
                                                         double voxel_m,
                                                         Distances distances);

}  // namespace wobblebench::phantoms
