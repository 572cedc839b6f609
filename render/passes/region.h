// Part of a picture or a slice.
#pragma once

namespace wobblebench::render {

/// Pixels of a rectangle.
struct Region {
  int column = 0;
  int row = 0;
  int columns = 0;
  int rows = 0;
};

}  // namespace wobblebench::render
