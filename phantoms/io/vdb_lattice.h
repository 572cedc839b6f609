// The lattices of grids of other programs.
#pragma once

#include <memory>

#include "phantoms/grids.h"

namespace wobblebench::phantoms {

/// The level set with its voxels along x, y and z: the grid itself where they are, a copy of its
/// band where axes are swapped or mirrored. Throws std::invalid_argument with one line for other
/// turned axes, and for voxels that are not cubes.
[[nodiscard]] std::shared_ptr<FloatGrid> along_axes(const std::shared_ptr<FloatGrid>& grid);

/// The level set on the lattice of `first`: the grid itself if it has the same origin, a copy of
/// its band where the origins lie whole voxels apart. Throws std::invalid_argument for other
/// voxels. Both lie along x, y and z.
[[nodiscard]] std::shared_ptr<FloatGrid> on_lattice_of(const FloatGrid& first,
                                                       const std::shared_ptr<FloatGrid>& grid);

}  // namespace wobblebench::phantoms
