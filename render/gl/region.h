// A rectangle of pixels.
#pragma once

namespace wobblebench::render {

/// A rectangle of a picture, slice or framebuffer, in pixels.
struct Region {
  int column = 0;
  int row = 0;
  int columns = 0;
  int rows = 0;
};

}  // namespace wobblebench::render
