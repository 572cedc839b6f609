// OpenVDB's grid of floats, and the operations on it that take seconds to compile: they are
// instantiated in float_grid.cpp only. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <glm/vec3.hpp>

#include "phantoms/grids.h"

#ifdef WOBBLEBENCH_TREES_OF_LIBRARY
// libopenvdb has these, though its headers say so of some functions only; a source that makes or
// copies a grid would compile all functions of the tree again, for 9 s.
extern template class openvdb::Grid<openvdb::FloatTree>;
extern template class openvdb::tree::Tree<openvdb::FloatTree::RootNodeType>;
extern template class openvdb::tree::Tree<openvdb::MaskTree::RootNodeType>;
#endif

namespace wobblebench::phantoms {

/// Registers OpenVDB's grid and metadata types, for reading and writing files. May be called often
/// and from any thread.
void initialize_openvdb();

/// An empty level set on cubic voxels, a voxel's centre at the origin.
[[nodiscard]] FloatGrid::Ptr create_level_set(double voxel_m, double background_m);

/// Whether the narrow band has voxels inside and outside the surface.
[[nodiscard]] bool has_both_sides(const FloatGrid& grid);

enum class Neighbours { faces, faces_and_edges };

/// The level set with its narrow band widened by `layers` layers of voxels; the new distances are
/// first order (fast sweeping: Zhao, Math. Comp. 74, 603, 2004). Over faces alone a band grows by
/// less than a voxel per layer along diagonals. A grid that has_both_sides() does not hold for, a
/// part cut out beside the surface say, is returned as it is.
[[nodiscard]] FloatGrid::Ptr widen_band(const FloatGrid& grid, int layers, Neighbours neighbours);

inline openvdb::Vec3d to_vdb(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}
inline glm::dvec3 to_glm(const openvdb::Vec3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace wobblebench::phantoms
