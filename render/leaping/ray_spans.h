// The part of the rays of each tile of a picture that can meet a cell of a set.
#pragma once

#include <vector>

#include "render/camera.h"
#include "render/geometry/slice_geometry.h"
#include "render/leaping/skippable_cells.h"

namespace wobblebench::render {

/// Pixels of a side of a tile.
inline constexpr int kTilePixels = 8;

/// Tiles of a side of a picture.
constexpr int tiles_per_side(int image_size) {
  return (image_size + kTilePixels - 1) / kTilePixels;
}

/// For each tile ([row][column]), the first and the last ray length in metres at which one of its
/// rays may lie in a cell of the set; where none does, the last is less than the first. Bounds, not
/// exact values: each cell counts as the box around its corners in the picture's axes.
std::vector<float> ray_spans(const CellBits& set,
                             const MacrocellGrid& grid,
                             const SliceGeometry& geometry,
                             const Camera& camera);

}  // namespace wobblebench::render
