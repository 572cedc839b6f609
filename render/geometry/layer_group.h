// Layers of the volume texture in mode fast.
#pragma once

namespace wobblebench::render {

/// Consecutive layers that are made together, out of `count` + 1 slices.
struct LayerGroup {
  int first = 0;
  int count = 0;
};

}  // namespace wobblebench::render
