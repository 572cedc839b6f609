// Signed-distance functions to OpenVDB level sets. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <string>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

/// Signed distance in metres, negative inside; must be safe to call from several threads.
using DistanceFunction = std::function<double(const glm::dvec3&)>;

/// Half width of the narrow bands, in voxels.
inline constexpr int kHalfWidthVoxels = 4;

enum class Distances {
  exact,       ///< the function is a distance: keep its values
  first_order  ///< exact on the surface only: solve |gradient| = 1 in the band
};

/// The narrow-band level set of the surface within `bounds` (which must hold it whole, or cut it
/// where nobody looks). The function is evaluated near its surface only; the grid's bytes do not
/// depend on the number of threads.
openvdb::FloatGrid::Ptr build_level_set(const std::string& name,
                                        const DistanceFunction& distance,
                                        const Box& bounds,
                                        double voxel_m,
                                        Distances distances);

/// Registers OpenVDB's types, once.
void initialize_openvdb();

}  // namespace wobblebench::phantoms
