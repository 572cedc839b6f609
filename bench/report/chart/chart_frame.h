// What charts have in common: title, axes with ticks, legend.
#pragma once

#include <string>
#include <vector>

#include "bench/report/chart/chart.h"

namespace wobblebench::bench {

/// One line of a legend.
struct LegendEntry {
  std::string name;
  Colour colour{0};
  Stroke stroke = Stroke::none;
  Mark mark = Mark::none;
  bool filled = false;  ///< a tinted box instead
};

/// Where things go on the sheet; all in pixels.
class ChartFrame {
 public:
  /// `row_texts`: what stands before the rows of a bar chart; empty: y has ticks.
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
  void draw_legend(const std::vector<LegendEntry>& legend, Place at);

  Canvas& canvas_;
  Box2 plot_;
};

inline constexpr double kTickText = 12;
inline constexpr double kLabelText = 13.5;
inline constexpr double kTitleText = 14.5;
inline constexpr int kMostTicks = 7;

}  // namespace wobblebench::bench
