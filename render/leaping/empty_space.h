// Mode fast: what rays can leap over, as textures.
#pragma once

#include <vector>

#include "render/geometry/slice_geometry.h"
#include "render/gl/objects.h"
#include "render/leaping/cell_bounds.h"
#include "render/leaping/skippable_cells.h"

namespace wobblebench::render {

/// Skippable cells of a volume, and from them, on demand, the textures that rays read that leap.
class EmptySpace {
 public:
  /// `bounds`: shared by the volumes of one grid; must outlive them.
  EmptySpace(SkippableCells cells, CellBoundsPass& bounds);

  /// Measures the layers that have changed; arguments as GroupsCallback.
  void update_bounds(const Texture& slices, const std::vector<LayerGroup>& groups);
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
  CellBoundsPass& bounds_;
  Texture distances_, spans_;
  bool changed_ = true;  ///< `distances_` and `spans_` are out of date
};

}  // namespace wobblebench::render
