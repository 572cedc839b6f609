// The lattices of grids of other programs. Heavy: include it from .cpp files only.
#pragma once

#include "phantoms/float_grid.h"

namespace wobblebench::phantoms {

/// The level set with its voxels along x, y and z: the grid itself where they are, a copy of its
/// band where axes are swapped or mirrored. Throws std::invalid_argument with one line for other
/// turned axes, and for voxels that are not cubes.
[[nodiscard]] FloatGrid::Ptr along_axes(const FloatGrid::Ptr& grid);

/// The level set on the lattice of `first`: the grid itself if it has the same origin, a copy of
/// its band where the origins lie whole voxels apart. Throws std::invalid_argument for other
/// voxels. Both lie along x, y and z.
[[nodiscard]] FloatGrid::Ptr on_lattice_of(const FloatGrid& first, const FloatGrid::Ptr& grid);

}  // namespace wobblebench::phantoms
