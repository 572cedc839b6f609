#include "bench/output/chart/chart.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "bench/output/chart/chart_frame.h"

namespace wobblebench::bench {

namespace {

constexpr double kMarkSize = 8;
const Colour kBandTint{0.86f, 0.91f, 0.95f};

int colour_of(const Chart& chart, std::size_t series) {
  const int given = chart.series[series].colour;
  return given >= 0 ? given : static_cast<int>(series);
}

std::vector<double> all_x(const Chart& chart) {
  std::vector<double> values;
  for (const auto& s : chart.series) values.insert(values.end(), s.x.begin(), s.x.end());
  return values;
}

std::vector<double> all_y(const Chart& chart) {
  std::vector<double> values;
  for (const auto& s : chart.series) {
    if (s.x.size() != s.y.size() || (!s.error.empty() && s.error.size() != s.y.size())) {
      throw std::invalid_argument("series " + s.name + ": x, y and error differ in number");
    }
    for (std::size_t i = 0; i < s.y.size(); ++i) {
      const double error = s.error.empty() ? 0 : s.error[i];
      values.insert(values.end(), {s.y[i] - error, s.y[i] + error});
    }
  }
  for (const auto& band : chart.bands) {
    values.insert(values.end(), band.low.begin(), band.low.end());
    values.insert(values.end(), band.high.begin(), band.high.end());
  }
  return values;
}

std::vector<LegendEntry> legend_of(const Chart& chart) {
  std::vector<LegendEntry> legend;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& s = chart.series[i];
    if (s.name.empty()) continue;
    legend.push_back({s.name, series_colour(colour_of(chart, i)), s.stroke, s.mark, false});
  }
  for (const auto& band : chart.bands) {
    if (!band.name.empty()) {
      legend.push_back({band.name, kBandTint, Stroke::none, Mark::none, true});
    }
  }
  return legend;
}

/// The mapping of values to pixels.
struct Window {
  Box2 plot;
  Ruler x;
  Ruler y;

  Point2 at(double vx, double vy) const {
    return {plot.low.x + x.fraction(vx) * plot.width(),
            plot.high.y - y.fraction(vy) * plot.height()};
  }
};

void draw_band(Canvas& canvas, const Window& window, const Band& band) {
  std::vector<Point2> outline;
  for (std::size_t i = 0; i < band.x.size(); ++i)
    outline.push_back(window.at(band.x[i], band.high[i]));
  for (std::size_t i = band.x.size(); i-- > 0;)
    outline.push_back(window.at(band.x[i], band.low[i]));
  canvas.fill(outline, kBandTint);
}

void draw_lines(Canvas& canvas, const Window& window, const Series& series, Colour colour) {
  std::vector<Point2> run;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const Point2 point = window.at(series.x[i], series.y[i]);
    if (std::isfinite(point.x) && std::isfinite(point.y)) {
      run.push_back(point);
    } else {
      canvas.line(run, colour, 1.8, series.stroke);
      run.clear();
    }
  }
  canvas.line(run, colour, 1.8, series.stroke);
  for (std::size_t i = 0; i < series.error.size(); ++i) {
    const Point2 low = window.at(series.x[i], series.y[i] - series.error[i]);
    const Point2 high = window.at(series.x[i], series.y[i] + series.error[i]);
    const Point2 serif(3.5, 0);
    canvas.line({low, high}, colour, 1.3, Stroke::solid);
    canvas.line({low - serif, low + serif}, colour, 1.3, Stroke::solid);
    canvas.line({high - serif, high + serif}, colour, 1.3, Stroke::solid);
  }
}

void draw_marks(Canvas& canvas, const Window& window, const Series& series, Colour colour) {
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (!window.x.contains(series.x[i]) || !window.y.contains(series.y[i])) continue;
    canvas.mark(window.at(series.x[i], series.y[i]), series.mark, colour, kMarkSize);
  }
}

/// The text stands to the right of its point, or to the left where the plot ends.
void draw_label(Canvas& canvas, const Window& window, const PointLabel& label) {
  const Point2 at = window.at(label.x, label.y);
  const bool left = at.x + 9 + Canvas::text_width(label.text, kTickText) > window.plot.high.x;
  canvas.text(
      at + Point2(left ? -9 : 9, -9), label.text, {.size = kTickText, .across = left ? 1.0 : 0});
}

double widest(const std::vector<Tick>& ticks) {
  double width = 0;
  for (const Tick& tick : ticks) width = std::max(width, Canvas::text_width(tick.text, kTickText));
  return width;
}

}  // namespace

Picture3 draw(const Chart& chart, PictureSize size) {
  Canvas canvas(size.width, size.height);
  const Ruler x(chart.x, all_x(chart)), y(chart.y, all_y(chart));
  ChartFrame frame(canvas, size, chart.title, legend_of(chart), widest(y.ticks(kMostTicks)), true);
  const Window window{frame.plot(), x, y};
  canvas.clip(frame.plot());
  for (const Band& band : chart.bands) draw_band(canvas, window, band);
  canvas.clip_nothing();
  frame.draw_x_axis(x, chart.x.label);
  frame.draw_y_axis(y, chart.y.label);
  canvas.clip(frame.plot());
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    draw_lines(canvas, window, chart.series[i], series_colour(colour_of(chart, i)));
  }
  canvas.clip_nothing();
  frame.draw_border();
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    draw_marks(canvas, window, chart.series[i], series_colour(colour_of(chart, i)));
  }
  for (const PointLabel& label : chart.labels) draw_label(canvas, window, label);
  return canvas.finish();
}

Picture3 draw(const BarChart& chart, PictureSize size) {
  std::vector<double> totals(chart.rows.size(), 0.0);
  std::vector<LegendEntry> legend;
  for (std::size_t p = 0; p < chart.parts.size(); ++p) {
    const BarPart& part = chart.parts[p];
    if (part.values.size() != chart.rows.size()) {
      throw std::invalid_argument("bars " + part.name + ": not one value a row");
    }
    for (std::size_t r = 0; r < totals.size(); ++r) totals[r] += part.values[r];
    legend.push_back(
        {part.name, series_colour(static_cast<int>(p)), Stroke::none, Mark::none, true});
  }
  double margin = 0;
  for (const auto& row : chart.rows) margin = std::max(margin, Canvas::text_width(row, kTickText));
  Canvas canvas(size.width, size.height);
  ChartFrame frame(canvas, size, chart.title, legend, margin, false);
  const Ruler x({.label = chart.label, .low = 0.0}, totals);
  frame.draw_x_axis(x, chart.label);
  const Box2& plot = frame.plot();
  const double pitch = plot.height() / static_cast<double>(chart.rows.size());
  for (std::size_t r = 0; r < chart.rows.size(); ++r) {
    const double middle = plot.low.y + (static_cast<double>(r) + 0.5) * pitch;
    const double half = std::min(0.32 * pitch, 18.0);
    double sum = 0;
    for (std::size_t p = 0; p < chart.parts.size(); ++p) {
      const double from = plot.low.x + x.fraction(sum) * plot.width();
      sum += chart.parts[p].values[r];
      const double to = plot.low.x + x.fraction(sum) * plot.width();
      canvas.fill(Box2{{from, middle - half}, {to, middle + half}},
                  series_colour(static_cast<int>(p)));
    }
    canvas.text({plot.low.x - 9, middle}, chart.rows[r], {.size = kTickText, .across = 1});
  }
  frame.draw_border();
  return canvas.finish();
}

Picture3 draw(const std::vector<GreyPanel>& panels, const std::string& note, int panel_width) {
  if (panels.empty()) throw std::invalid_argument("panels: none to show");
  constexpr int kGap = 12, kTop = 34, kBottom = 34;
  const auto& first = panels.front().values;
  const int height = panel_width * first.height / std::max(1, first.width);
  const int count = static_cast<int>(panels.size());
  Canvas canvas(kGap + count * (panel_width + kGap), kTop + height + kBottom);
  for (int i = 0; i < count; ++i) {
    const GreyPanel& panel = panels[static_cast<std::size_t>(i)];
    const Point2 corner(kGap + i * (panel_width + kGap), kTop);
    canvas.picture({corner, corner + Point2(panel_width, height)}, panel.values);
    canvas.text(corner + Point2(0.5 * panel_width, -9),
                panel.title,
                {.size = kLabelText, .across = 0.5, .down = 1});
  }
  canvas.text({kGap, kTop + height + 11}, note, {.size = kTickText, .down = 0});
  return canvas.finish();
}

Picture3 side_by_side(const std::vector<Picture3>& pictures) {
  if (pictures.empty()) throw std::invalid_argument("pictures: none to show");
  int width = 0, height = 0;
  for (const auto& picture : pictures) {
    width += picture.width;
    height = std::max(height, picture.height);
  }
  Picture3 all(width, height, Colour(1));
  int left = 0;
  for (const auto& picture : pictures) {
    for (int row = 0; row < picture.height; ++row) {
      for (int column = 0; column < picture.width; ++column) {
        all.at(left + column, row) = picture.at(column, row);
      }
    }
    left += picture.width;
  }
  return all;
}

}  // namespace wobblebench::bench
