// Mode fast: what rays may leap over, on the GPU.
#pragma once

#include <vector>

#include "render/gl/program.h"
#include "render/leaping/skippable_cells.h"
#include "render/passes/fast_scan_converter.h"

namespace wobblebench::render {

/// Keeps up with the slices: takes the bounds of those that change, and makes the map of distances
/// when it is asked for.
class EmptySpace {
 public:
  explicit EmptySpace(SkippableCells cells);

  /// These pairs of slices have changed: see GroupDone.
  void bound(const Texture& slices, int index, const LayerGroup& layers);
  void look(const RenderOptions& options);

  /// Distances in cells over 255; columns, rows and intervals of the lattice.
  const Texture& distances();

  const SkippableCells& cells() const { return cells_; }

 private:
  SkippableCells cells_;
  Texture values_and_x_, depth_and_frame_;  ///< bounds of cells, a layer for each interval
  Texture distances_;
  FragmentProgram bound_;
  std::vector<bool> unread_;  ///< bounds that `cells_` has not, for each interval
  bool changed_ = true;
};

}  // namespace wobblebench::render
