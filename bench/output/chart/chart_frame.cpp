#include "bench/output/chart/chart_frame.h"

#include <algorithm>

namespace wobblebench::bench {

namespace {

constexpr double kEdge = 14;  // of the picture
constexpr double kTickLength = 5;
constexpr double kLegendRow = 20;
constexpr double kLegendSample = 30;  // length of the line before a name
constexpr double kLineWidth = 1.1;

double legend_width(const std::vector<LegendEntry>& legend) {
  double widest = 0;
  for (const auto& entry : legend) {
    widest = std::max(widest, Canvas::text_width(entry.name, kTickText));
  }
  return legend.empty() ? 0 : widest + kLegendSample + 20;
}

}  // namespace

ChartFrame::ChartFrame(Canvas& canvas,
                       PictureSize size,
                       const std::string& title,
                       const std::vector<LegendEntry>& legend,
                       double left_margin,
                       bool y_label)
    : canvas_(canvas) {
  const double label = y_label ? kLabelText + 14 : 0;
  plot_.low = {kEdge + label + left_margin + kTickLength + 4, kEdge + (title.empty() ? 4 : 28)};
  plot_.high = {size.width - kEdge - legend_width(legend) - 6,
                size.height - kEdge - kTickText - kLabelText - 22};
  if (!title.empty()) {
    canvas.text({plot_.low.x, kEdge}, title, {.size = kTitleText, .down = 0});
  }
  draw_legend(legend, {plot_.high.x + 14, plot_.low.y + 10});
}

void ChartFrame::draw_legend(const std::vector<LegendEntry>& legend, Point2 at) {
  for (const LegendEntry& entry : legend) {
    const Point2 end = at + Point2(kLegendSample - 6, 0);
    if (entry.filled) {
      canvas_.fill(Box2{at - Point2(0, 6), end + Point2(0, 6)}, entry.colour);
    } else {
      canvas_.line({at, end}, entry.colour, 1.8, entry.stroke);
      canvas_.mark(0.5 * (at + end), entry.mark, entry.colour, 8);
    }
    canvas_.text({at.x + kLegendSample, at.y}, entry.name, {.size = kTickText});
    at.y += kLegendRow;
  }
}

void ChartFrame::draw_x_axis(const Ruler& ruler, const std::string& label) {
  for (const Tick& tick : ruler.ticks(kMostTicks)) {
    const double x = plot_.low.x + ruler.fraction(tick.value) * plot_.width();
    canvas_.line({{x, plot_.low.y}, {x, plot_.high.y}}, kGridInk, 1, Stroke::solid);
    canvas_.line({{x, plot_.high.y}, {x, plot_.high.y + kTickLength}}, kInk, 1, Stroke::solid);
    canvas_.text({x, plot_.high.y + kTickLength + 5},
                 tick.text,
                 {.size = kTickText, .across = 0.5, .down = 0});
  }
  canvas_.text({0.5 * (plot_.low.x + plot_.high.x), plot_.high.y + kTickLength + kTickText + 13},
               label,
               {.size = kLabelText, .across = 0.5, .down = 0});
}

void ChartFrame::draw_y_axis(const Ruler& ruler, const std::string& label) {
  for (const Tick& tick : ruler.ticks(kMostTicks)) {
    const double y = plot_.high.y - ruler.fraction(tick.value) * plot_.height();
    canvas_.line({{plot_.low.x, y}, {plot_.high.x, y}}, kGridInk, 1, Stroke::solid);
    canvas_.line({{plot_.low.x - kTickLength, y}, {plot_.low.x, y}}, kInk, 1, Stroke::solid);
    canvas_.text({plot_.low.x - kTickLength - 4, y}, tick.text, {.size = kTickText, .across = 1});
  }
  canvas_.text({kEdge + 0.5 * kLabelText, 0.5 * (plot_.low.y + plot_.high.y)},
               label,
               {.size = kLabelText, .across = 0.5, .upwards = true});
}

void ChartFrame::draw_border() {
  canvas_.line(
      {plot_.low, {plot_.high.x, plot_.low.y}, plot_.high, {plot_.low.x, plot_.high.y}, plot_.low},
      kInk,
      kLineWidth,
      Stroke::solid);
}

}  // namespace wobblebench::bench
