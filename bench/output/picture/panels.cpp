#include "bench/output/picture/panels.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "base/number_text.h"
#include "bench/output/picture/canvas.h"

namespace wobblebench::bench {

namespace {

constexpr double kMargin = 12, kTop = 34, kTitle = 15, kSmall = 12, kLine = 20;
constexpr double kBarGap = 10, kBarWidth = 14, kBarRoom = 84;
constexpr double kSwatch = 11, kNameGap = 16;
constexpr double kScaleBar_mm = 10;

/// Where the parts of a row of panels are, in pixels.
struct Layout {
  double side = 0;    ///< width of a picture
  double height = 0;  ///< of the tallest
  std::vector<double> left;
  double width = 0;     ///< of all
  int lines_below = 0;  ///< of names and scale bars, of the panel with most
};

double height_of(const Picture3& picture, double side) {
  if (picture.pixels.empty()) return side;
  return std::round(side * picture.height / picture.width);
}

std::vector<ColourName> names_of(const Panel& panel) {
  std::vector<ColourName> names = panel.names;
  for (const PanelLines& lines : panel.lines) names.push_back(lines.of);
  return names;
}

/// Names of colours in lines of the panel's width: the number of each line's first name.
std::vector<std::size_t> lines_of_names(const std::vector<ColourName>& names, double side) {
  std::vector<std::size_t> first;
  double used = side;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double room = kSwatch + 5 + Canvas::text_width(names[i].name, kSmall) + kNameGap;
    if (used + room - kNameGap > side) {
      first.push_back(i);
      used = 0;
    }
    used += room;
  }
  return first;
}

bool has_scale_bar(const Panel& panel) {
  return panel.instead.empty() && panel.mm_per_pixel > 0;
}

int lines_below(const Panel& panel, double side) {
  if (!panel.instead.empty()) return 0;
  return (has_scale_bar(panel) ? 1 : 0) +
         static_cast<int>(lines_of_names(names_of(panel), side).size());
}

Layout layout_of(const std::vector<Panel>& panels, double side) {
  Layout layout{.side = side};
  double left = kMargin;
  for (const Panel& panel : panels) {
    layout.left.push_back(left);
    left += side + (panel.bar && panel.instead.empty() ? kBarRoom : 0) + kMargin;
    layout.height = std::max(layout.height, height_of(panel.picture, side));
    layout.lines_below = std::max(layout.lines_below, lines_below(panel, side));
  }
  layout.width = left;
  return layout;
}

int digits_of(double step) {
  return std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
}

void draw_bar(Canvas& canvas, const ColourBar& bar, const Box2& box) {
  constexpr int kSteps = 256;
  Picture3 ramp(1, kSteps);
  for (int i = 0; i < kSteps; ++i) ramp.at(0, i) = bar.colours(1 - (i + 0.5) / kSteps);
  canvas.picture(box, ramp);
  const double step = tick_step(bar.low, bar.high, static_cast<int>(box.height() / 28) + 1);
  const double first = std::ceil(bar.low / step - 1e-9);
  const int ticks = static_cast<int>(std::floor(bar.high / step + 1e-9) - first) + 1;
  for (int i = 0; i < ticks; ++i) {
    const double value = (first + i) * step;
    const double y = box.high.y - box.height() * (value - bar.low) / (bar.high - bar.low);
    canvas.line({{box.high.x, y}, {box.high.x + 4, y}}, kInk, 1);
    canvas.text({box.high.x + 7, y}, fixed(value + 0.0, digits_of(step)), {.size = kSmall});
  }
  canvas.text({box.high.x + 44, 0.5 * (box.low.y + box.high.y)},
              bar.label,
              {.size = kSmall, .across = 0.5, .down = 0, .upwards = true});
}

void draw_scale_bar(Canvas& canvas, double mm_per_pixel, Point2 corner, double side) {
  const double length = kScaleBar_mm / mm_per_pixel;
  // Wider than the picture, it would say nothing of it.
  if (length > side) return;
  canvas.fill(Box2{corner - Point2(0, 1.5), corner + Point2(length, 1.5)}, kInk);
  canvas.text(corner + Point2(length + 7, 0), "10 mm", {.size = kSmall});
}

void draw_names(Canvas& canvas, const std::vector<ColourName>& names, Point2 corner, double side) {
  const auto first = lines_of_names(names, side);
  Point2 at = corner;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0 && std::ranges::find(first, i) != first.end()) at = {corner.x, at.y + kLine};
    const double half = 0.5 * kSwatch;
    canvas.fill(Box2{at - Point2(0, half), at + Point2(kSwatch, half)}, kInk);
    canvas.fill(Box2{at - Point2(-1, half - 1), at + Point2(kSwatch - 1, half - 1)},
                names[i].colour);
    canvas.text(at + Point2(kSwatch + 5, 0), names[i].name, {.size = kSmall});
    at.x += kSwatch + 5 + Canvas::text_width(names[i].name, kSmall) + kNameGap;
  }
}

/// Over a picture of these many columns.
void draw_lines(Canvas& canvas, const PanelLines& lines, const Box2& box, int columns) {
  const double scale = box.width() / columns;
  canvas.clip(box);
  for (const auto& [from, to] : lines.segments) {
    canvas.line({box.low + scale * (from + 0.5), box.low + scale * (to + 0.5)},
                lines.of.colour,
                lines.width);
  }
  canvas.clip_nothing();
}

/// The text in lines no wider than `width` where it has spaces to break it at.
std::vector<std::string> wrapped(const std::string& text, double width, double text_size) {
  std::vector<std::string> lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.empty() ? word : lines.back() + " " + word;
    if (!lines.empty() && Canvas::text_width(longer, text_size) <= width) {
      lines.back() = longer;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

void draw_words(Canvas& canvas, const std::string& words, const Box2& box) {
  canvas.fill(box, kGridInk);
  const auto lines = wrapped(words, box.width() - 4 * kMargin, kTitle);
  const Point2 middle = 0.5 * (box.low + box.high);
  double y = middle.y - 0.5 * 22 * (static_cast<double>(lines.size()) - 1);
  for (const std::string& line : lines) {
    canvas.text({middle.x, y}, line, {.size = kTitle, .across = 0.5});
    y += 22;
  }
}

void draw_panel(Canvas& canvas, const Panel& panel, double left, double side) {
  const Box2 box{{left, kTop}, {left + side, kTop + height_of(panel.picture, side)}};
  canvas.text({left, kTop - 10}, panel.title, {.size = kTitle, .down = 1});
  if (!panel.instead.empty()) return draw_words(canvas, panel.instead, box);
  canvas.picture(box, panel.picture);
  for (const PanelLines& lines : panel.lines) draw_lines(canvas, lines, box, panel.picture.width);
  const double bar_left = box.high.x + kBarGap;
  if (panel.bar)
    draw_bar(canvas, *panel.bar, {{bar_left, kTop}, {bar_left + kBarWidth, box.high.y}});
  Point2 below(left, box.high.y + 16);
  if (has_scale_bar(panel)) {
    draw_scale_bar(canvas, panel.mm_per_pixel * panel.picture.width / side, below, side);
    below.y += kLine;
  }
  draw_names(canvas, names_of(panel), below, side);
}

}  // namespace

double tick_step(double low, double high, int most) {
  const double least = (high - low) / std::max(1, most - 1);
  const double decade = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= least * (1 - 1e-9)) return factor * decade;
  }
  return 10 * decade;
}

Picture3 draw_panels(const std::vector<Panel>& panels, int side) {
  if (panels.empty()) throw std::invalid_argument("panels: none to show");
  const Layout layout = layout_of(panels, side);
  const double below = layout.lines_below > 0 ? 8 + layout.lines_below * kLine : 0;
  Canvas canvas(static_cast<int>(layout.width),
                static_cast<int>(kTop + layout.height + below + kMargin));
  for (std::size_t i = 0; i < panels.size(); ++i) {
    draw_panel(canvas, panels[i], layout.left[i], layout.side);
  }
  return canvas.finish();
}

}  // namespace wobblebench::bench
