// Charts of reports: lines and markers, stacked bars, grey pictures. Texts are ASCII.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/output/chart/chart_canvas.h"
#include "render/picture.h"

namespace wobblebench::bench {

enum class Scale { linear, logarithmic };

struct Tick {
  double value = 0;
  std::string text;
};

struct Axis {
  std::string label;  ///< with its unit: "range (mm)"
  Scale scale = Scale::linear;
  /// Ends; from the data unless given.
  std::optional<double> low;
  std::optional<double> high;
  std::vector<Tick> ticks;  ///< round numbers unless given
};

/// An axis with known ends.
class Ruler {
 public:
  /// Ends that the axis leaves open follow from `values` (those that are finite and, on a
  /// logarithmic axis, positive), with a small margin beyond them. Throws std::invalid_argument
  /// where nothing can be shown.
  Ruler(const Axis& axis, const std::vector<double>& values);

  double low() const { return low_; }
  double high() const { return high_; }
  bool contains(double value) const { return value >= low_ && value <= high_; }
  /// Position along the axis: 0 at the low end, 1 at the high one.
  double fraction(double value) const;
  /// The axis's own, or else at 1, 2 or 5 times a power of ten, at most about `most` of them.
  std::vector<Tick> ticks(int most) const;

 private:
  std::vector<Tick> linear_ticks(int most) const;
  std::vector<Tick> logarithmic_ticks(int most) const;

  Scale scale_;
  std::vector<Tick> ticks_;  ///< given
  double low_;
  double high_;
};

using Picture3 = Image<glm::vec3>;

struct Series {
  std::string name;  ///< in the legend; empty: not in it
  std::vector<double> x;
  std::vector<double> y;  ///< as many; NaN leaves a gap
  Stroke stroke = Stroke::solid;
  Mark mark = Mark::none;
  int colour = -1;            ///< of series_colour(); -1: the series' number
  std::vector<double> error;  ///< half length of the bar at each point; empty: none
};

/// A tinted area between two lines, as of a tolerance.
struct Band {
  std::string name;
  std::vector<double> x;
  std::vector<double> low;
  std::vector<double> high;
};

/// A text beside a point.
struct PointLabel {
  double x = 0;
  double y = 0;
  std::string text;
};

struct Chart {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Band> bands;
  std::vector<Series> series;
  std::vector<PointLabel> labels;
};

/// Bars along the horizontal axis, one a row, each of parts.
struct BarPart {
  std::string name;
  std::vector<double> values;  ///< of each row
};
struct BarChart {
  std::string title;
  std::string label;  ///< of the values, with their unit
  std::vector<std::string> rows;
  std::vector<BarPart> parts;
};

/// Grey pictures side by side, all of one size.
struct GreyPanel {
  std::string title;
  Image<float> values;  ///< in [0, 1]
};

struct PictureSize {
  int width = 680;
  int height = 420;
};

/// Throws std::invalid_argument where there is nothing to show.
Picture3 draw(const Chart& chart, PictureSize size = {});
Picture3 draw(const BarChart& chart, PictureSize size = {});
/// `note`: text below the pictures.
Picture3 draw(const std::vector<GreyPanel>& panels, const std::string& note, int panel_width);
/// From left to right, all of one height.
Picture3 side_by_side(const std::vector<Picture3>& pictures);

struct Figure {
  std::string name;     ///< of the file, without prefix and extension
  std::string caption;  ///< one sentence
  Picture3 picture;
};

}  // namespace wobblebench::bench
