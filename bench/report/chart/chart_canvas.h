// A white sheet to draw on, several times as fine as the picture that it becomes, so that lines and
// letters come out smooth. OpenCV stays in the .cpp.
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

/// Okabe and Ito's colours, which people with any colour vision tell apart; repeats after seven.
Colour series_colour(int index);

inline const Colour kInk{0.13f, 0.13f, 0.13f};
inline const Colour kGridInk{0.88f, 0.88f, 0.88f};

enum class Stroke { none, solid, dashed, dotted };
enum class Mark { none, disc, ring, square, triangle, diamond };

/// Pixels of the finished picture; y grows downwards.
using Place = glm::dvec2;

struct Box2 {
  Place low{0};   ///< upper left
  Place high{0};  ///< lower right
  double width() const { return high.x - low.x; }
  double height() const { return high.y - low.y; }
};

struct TextStyle {
  double size = 13;      ///< height of a capital letter times 1.4, pixels
  double across = 0;     ///< 0: begins at the place, 0.5: centred on it, 1: ends there
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

  /// Until the next call nothing is drawn outside of the box.
  void clip(const Box2& box);
  void clip_nothing();

  void line(const std::vector<Place>& places, Colour colour, double width, Stroke stroke);
  void fill(const std::vector<Place>& corners, Colour colour);
  void fill(const Box2& box, Colour colour);
  void mark(Place place, Mark mark, Colour colour, double size);
  void text(Place place, const std::string& text, const TextStyle& style = {});
  /// Grey values in [0, 1], stretched over the box.
  void picture(const Box2& box, const Image<float>& values);

  /// Length of a text, pixels.
  static double text_width(const std::string& text, double size);

  Image<glm::vec3> finish() const;

 private:
  struct Sheet;
  std::unique_ptr<Sheet> sheet_;
};

}  // namespace wobblebench::bench
