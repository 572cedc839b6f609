// Pictures side by side with what one needs to read them: titles, colour bars, a scale bar, the
// names of colours.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/output/picture/colour_map.h"

namespace wobblebench::bench {

/// The meaning of a picture's colours: a bar to its right.
struct ColourBar {
  ColourMap colours = diverging;
  double low = 0;
  double high = 1;
  std::string label;  ///< with the unit: "found minus true (mm)"
};

/// A colour that stands for a kind of pixel.
struct ColourName {
  glm::vec3 colour{0};
  std::string name;
};

/// Ends of a line in pixels of a picture: column and row, 0 at the first pixel's centre.
using Segment = std::array<glm::dvec2, 2>;

/// Lines over a picture.
struct PanelLines {
  ColourName of;
  std::vector<Segment> segments;
  double width = 1.4;  ///< pixels of the panel
};

struct Panel {
  std::string title;
  Picture3 picture;                    ///< display values; square or not
  std::string instead = {};            ///< words in place of the picture; empty: the picture
  std::optional<ColourBar> bar = {};   ///< none: the picture's colours are no numbers
  std::vector<ColourName> names = {};  ///< below the picture
  std::vector<PanelLines> lines = {};  ///< their names come below the picture, too
  double mm_per_pixel = 0;             ///< of `picture`, for a scale bar of 10 mm; 0: none
};

/// From left to right on white, each as wide as `side`, in ASCII. A picture that is stretched to
/// `side` by a whole number keeps its pixels. Throws std::invalid_argument where there is none.
Picture3 draw_panels(const std::vector<Panel>& panels, int side);

/// 1, 2 or 5 times a power of ten such that the numbers from `low` to `high` that are multiples of
/// it are at most `most`.
double tick_step(double low, double high, int most);

}  // namespace wobblebench::bench
