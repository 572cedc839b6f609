// Mode fast: the map of skippable cells on the GPU, for empty-space leaping.
#pragma once

#include <vector>

#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/leaping/skippable_cells.h"

namespace wobblebench::render {

/// Computes bounds of the cells of slices that change on the GPU, and from them the texture of
/// distances, on demand.
class EmptySpace {
 public:
  /// `bounds_program`: shared by the volumes of one grid, made by the first; must outlive them.
  EmptySpace(SkippableCells cells, FragmentProgram& bounds_program);

  /// Computes the bounds of layers that have changed; arguments as GroupCallback.
  void update_bounds(const Texture& slices, int index, const LayerGroup& layers);
  /// Cells of the same slices for other settings of rays.
  void set_cells(SkippableCells cells);
  void set_view(const RenderOptions& options);
  void set_level(double level);
  void set_covered(const FrameSpan& covered);

  /// cell_distances() of the cells to sample, over 255; columns x rows x intervals of the grid.
  const Texture& distances();
  /// ray_spans() of the cells to sample, a texel for each tile.
  const Texture& spans();

  const SkippableCells& cells() const { return cells_; }

 private:
  void refresh();

  SkippableCells cells_;
  Texture values_and_x_, depth_and_frame_;  ///< bounds of cells, one layer per interval
  Texture distances_, spans_;
  FragmentProgram& bounds_program_;
  std::vector<bool> outdated_;  ///< per interval: bounds not yet passed to `cells_`
  bool changed_ = true;         ///< `distances_` and `spans_` are out of date
};

}  // namespace wobblebench::render
