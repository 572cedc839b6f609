// Charts as data: lines and marks with intervals, and stacked bars. They are written as Vega-Lite
// specifications, which report.html and script/charts draw.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace wobblebench::bench {

enum class Scale { linear, logarithmic };
enum class Stroke { none, solid, dashed };
enum class Mark { none, disc, ring, square, triangle, diamond };

struct Axis {
  std::string label = {};  ///< with its unit: "range (mm)"
  Scale scale = Scale::linear;
  /// Ends; from the data unless given.
  std::optional<double> low = {};
  std::optional<double> high = {};
  std::vector<double> ticks = {};  ///< round numbers unless given
  /// Names shown at 0, 1, … in place of numbers, as of settings.
  std::vector<std::string> names = {};
};

/// One line or one kind of mark. A value that is not finite, or not positive on a logarithmic axis,
/// is left out and leaves a gap in the line.
struct Series {
  std::string name;  ///< in the legend; empty: not in it
  std::vector<double> x = {};
  std::vector<double> y = {};  ///< as many
  Stroke stroke = Stroke::solid;
  Mark mark = Mark::none;
  int colour = -1;  ///< of the palette of seven (Okabe and Ito); -1: the series' number
  /// Ends of an interval in y at each point; empty: none.
  std::vector<double> low = {};
  std::vector<double> high = {};
  /// What each point is about: Detail::id and Table::ids of the same document; empty: nothing.
  std::vector<std::string> ids = {};
  /// More that the pointer shows of each point ("steps 256, detector iso"); empty: nothing.
  std::vector<std::string> notes = {};

  void add(double at_x, double at_y) {
    x.push_back(at_x);
    y.push_back(at_y);
  }
};

struct Chart {
  std::string title;
  Axis x;
  Axis y;
  std::vector<Series> series = {};
};

/// Bars along the horizontal axis, one a row, each of parts.
struct BarPart {
  std::string name;
  std::vector<double> values = {};  ///< of each row
};
struct BarChart {
  std::string title;
  std::string label;  ///< of the values, with their unit
  std::vector<std::string> rows = {};
  std::vector<BarPart> parts = {};
};

/// Charts under one caption, two in a row; on a narrow page, one below the other.
struct Figure {
  std::string name;     ///< of [a-z0-9_]: of its file, without prefix and extension
  std::string caption;  ///< one sentence
  std::vector<std::variant<Chart, BarChart>> panels;
};

/// A Vega-Lite 6 specification, data included. A chart without any value that has a place says
/// "nothing to show".
nlohmann::ordered_json specification(const Chart& chart);
nlohmann::ordered_json specification(const BarChart& chart);
/// All panels.
nlohmann::ordered_json specification(const Figure& figure);

}  // namespace wobblebench::bench
