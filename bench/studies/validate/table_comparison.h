// What studies measured of the beam against the yardstick's tables: checks of the place that fits
// worst, points for the CSV file, charts.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bench/output/chart/chart.h"
#include "bench/studies/validate/study_report.h"
#include "bench/studies/validate/yardstick/yardstick.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct BeamWidth {
  const char* name;
  double BeamRow::*value;
};
inline constexpr BeamWidth kLateral{"lateral", &BeamRow::lateral_m};
inline constexpr BeamWidth kElevation{"elevation", &BeamRow::elevation_m};
inline constexpr BeamWidth kAxial{"axial", &BeamRow::axial_m};

/// The axis: the middle stick. Towards the edge: all others.
enum class StickPlaces { axis, edge };

std::vector<BeamComparison> at_places(std::span<const BeamComparison> found,
                                      StickPlaces places,
                                      double from_m,
                                      double to_m);

/// How many observations each figure rests on.
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

/// A rung in a chart.
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
