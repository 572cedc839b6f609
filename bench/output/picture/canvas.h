// Drawing of lines, text and pictures on white, supersampled for anti-aliasing. OpenCV stays in the
// .cpp.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "render/picture.h"

namespace wobblebench::bench {

/// Display values in [0, 1].
using Colour = glm::vec3;

inline const Colour kInk{0.13f, 0.13f, 0.13f};
inline const Colour kGridInk{0.88f, 0.88f, 0.88f};

/// Pixels of the finished picture; y grows downwards.
using Point2 = glm::dvec2;

struct Box2 {
  Point2 low{0};   ///< upper left
  Point2 high{0};  ///< lower right
  double width() const { return high.x - low.x; }
  double height() const { return high.y - low.y; }
};

struct TextStyle {
  double size = 13;      ///< height of a capital letter times 1.4, pixels
  double across = 0;     ///< 0: begins at the position, 0.5: centred on it, 1: ends there
  double down = 0.5;     ///< 0: below the place, 0.5: centred on it, 1: above it
  bool upwards = false;  ///< turned to read from below
  Colour colour = kInk;
};

class Canvas {
 public:
  Canvas(int width, int height);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Restricts drawing to the box.
  void clip(const Box2& box);
  void clip_nothing();

  void line(const std::vector<Point2>& points, Colour colour, double width);
  void fill(const std::vector<Point2>& corners, Colour colour);
  void fill(const Box2& box, Colour colour);
  void text(Point2 position, const std::string& text, const TextStyle& style = {});
  /// Values in [0, 1], stretched over the box. Pixels keep their edges where they
  /// become a whole number of pixels, or at least twice as wide.
  void picture(const Box2& box, const Image<glm::vec3>& values);

  /// Length of a text, pixels.
  static double text_width(const std::string& text, double size);

  Image<glm::vec3> finish() const;

 private:
  struct Sheet;
  std::unique_ptr<Sheet> sheet_;
};

}  // namespace wobblebench::bench
