// The report of a study: checks, measured points and figures; and what several studies report alike
// of beams measured against the yardstick's tables.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bench/output/document/chart.h"
#include "bench/output/document/table.h"
#include "bench/studies/validate/common/yardstick.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// A measured value against what it should be.
struct Check {
  enum class Kind {
    within,    ///< |measured - expected| <= tolerance
    at_least,  ///< measured >= expected
    at_most,   ///< measured <= expected
  };

  std::string name;  ///< dotted: study.what.where
  Kind kind = Kind::within;
  double measured = 0;
  double expected = 0;
  double tolerance = 0;
  std::string unit;                  ///< of all three; "1" for pure numbers
  std::string source;                ///< of what is expected: a closed form or a publication
  long n = 0;                        ///< number of observations …
  std::string of;                    ///< … of this kind
  std::vector<std::uint64_t> seeds;  ///< empty: nothing random in it

  bool passed() const;

  // The parts of a check, one after the other.
  Check& within(double value, double wanted, double allowed, const std::string& their_unit);
  Check& at_least(double value, double bar, const std::string& their_unit);
  Check& at_most(double value, double bar, const std::string& their_unit);
  Check& from(const std::string& text);
  Check& over(long count, const std::string& kind_of, std::vector<std::uint64_t> with_seeds = {});
};

/// One row of the CSV file. Names include their unit.
struct DataPoint {
  std::string series;
  std::string x_name;
  double x = 0;
  std::string y_name;
  double y = 0;
  std::optional<double> expected;
};

struct StudyReport {
  std::string id;  ///< these two by run_study()
  std::string title;
  std::string text;  ///< Markdown: method and findings
  std::vector<Check> checks;
  std::vector<DataPoint> points;
  std::vector<Figure> figures;
  std::vector<Table> tables = {};  ///< below the text

  /// Adds a check, whose parts follow in the same statement.
  Check& check(const std::string& name);

  struct X {
    std::string name;
    double value = 0;
  };
  struct Y {
    std::string name;
    double value = 0;
    std::optional<double> expected;
  };
  /// Adds a point.
  void point(const std::string& series, const X& x, const Y& y);
};

struct BeamWidth {
  const char* name;
  double BeamRow::*value;
};
inline constexpr BeamWidth kLateral{"lateral", &BeamRow::lateral_m};
inline constexpr BeamWidth kElevation{"elevation", &BeamRow::elevation_m};
inline constexpr BeamWidth kAxial{"axial", &BeamRow::axial_m};

/// Axis: the middle stick. Edge: all others, up to the last one.
enum class StickPlaces { axis, edge };

std::vector<BeamComparison> at_places(std::span<const BeamComparison> found,
                                      StickPlaces places,
                                      double from_m,
                                      double to_m);

/// The kind of the observations that a figure rests on, and their seeds.
struct CheckedOver {
  std::string of = "places";
  std::vector<std::uint64_t> seeds;
};

/// Largest relative error of a width, in percent. A figure that is NaN is the worst.
Check worst_width(const std::string& name,
                  std::span<const BeamComparison> found,
                  const BeamWidth& width,
                  double bar_percent,
                  const CheckedOver& over = {});
/// Largest error of the level in dB.
Check worst_level(const std::string& name,
                  std::span<const BeamComparison> found,
                  double bar_db,
                  const CheckedOver& over = {});

/// Widths and levels with those expected; what is NaN is left out.
void add_points(const std::string& series,
                std::span<const BeamComparison> found,
                StudyReport& report);

/// A rung whose speckle is measured.
struct SpeckleRung {
  const char* name;
  sim::Rung rung;
  bool side_lobes;
  Mark mark;
};
inline constexpr SpeckleRung kSpeckleRungs[] = {
    {"field", sim::Rung::field, false, Mark::square},
    {"scatterers", sim::Rung::scatterers, false, Mark::disc},
    {"scatterers_side_lobes", sim::Rung::scatterers, true, Mark::triangle}};

/// A rung in a chart, with its measured widths.
struct ChartedRung {
  std::string name;
  Mark mark = Mark::disc;
  std::vector<BeamComparison> found;
};
/// Figure `study`_PRESET: widths across lines and across frames over range. Lines are the table's,
/// one colour for each of its angles. `what`: whose widths, for the caption.
Figure widths_figure(const std::string& study,
                     const std::string& what,
                     hw::ProbePreset preset,
                     std::span<const ChartedRung> rungs);

}  // namespace wobblebench::bench
