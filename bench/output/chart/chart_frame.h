// Title, axes with ticks, and legend of a chart.
#pragma once

#include <string>
#include <vector>

#include "bench/output/chart/chart.h"

namespace wobblebench::bench {

/// One line of a legend.
struct LegendEntry {
  std::string name;
  Colour colour{0};
  Stroke stroke = Stroke::none;
  Mark mark = Mark::none;
  bool filled = false;  ///< a tinted box instead
};

/// The layout of a chart, in pixels.
class ChartFrame {
 public:
  /// `left_margin`: width of the texts beside the plot. `y_label`: whether y has a label.
  ChartFrame(Canvas& canvas,
             PictureSize size,
             const std::string& title,
             const std::vector<LegendEntry>& legend,
             double left_margin,
             bool y_label);

  const Box2& plot() const { return plot_; }

  void draw_x_axis(const Ruler& ruler, const std::string& label);
  void draw_y_axis(const Ruler& ruler, const std::string& label);
  void draw_border();

 private:
  void draw_legend(const std::vector<LegendEntry>& legend, Point2 at);

  Canvas& canvas_;
  Box2 plot_;
};

inline constexpr double kTickText = 12;
inline constexpr double kLabelText = 13.5;
inline constexpr double kTitleText = 14.5;
inline constexpr int kMostTicks = 7;

}  // namespace wobblebench::bench
