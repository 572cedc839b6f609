// Mode fast: bounds of macrocells, computed from slices on the GPU.
#pragma once

#include <vector>

#include "render/geometry/slice_geometry.h"
#include "render/gl/program.h"
#include "render/leaping/skippable_cells.h"

namespace wobblebench::render {

/// The bounds of the cells between slices, for the volumes of one grid.
class CellBoundsPass {
 public:
  /// `with_slopes`: also the changes from pixel to pixel and from frame to frame, which only a
  /// detector of edges asks for (Detector::paper); they stay 0 otherwise.
  CellBoundsPass(const MacrocellGrid& grid, bool with_slopes);

  /// Bounds of a layer, that is of an interval between two frames.
  struct Layer {
    int interval = 0;
    std::vector<MacrocellBounds> bounds;  ///< [row][column]
  };
  /// Of all layers of `groups`, at most kGroupsPerBatch, waiting until the GPU is done; arguments
  /// as GroupsCallback.
  std::vector<Layer> measure(const Texture& slices, const std::vector<LayerGroup>& groups);

 private:
  MacrocellGrid grid_;
  bool with_slopes_;
  std::vector<Texture> values_and_x_,
      depth_and_frame_;  ///< one per layer of a group, groups in rows
  Framebuffer target_;
  FragmentProgram program_;
};

}  // namespace wobblebench::render
