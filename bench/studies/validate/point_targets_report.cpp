#include "bench/studies/validate/study_reports.h"
#include "bench/studies/validate/table_comparison.h"

namespace wobblebench::bench {

namespace {

constexpr double kFrom_m = 30e-3, kTo_m = 160e-3;
constexpr double kAxisBar = 5, kEdgeBar = 10;  // percent
constexpr double kLevelBar_db = 0.5;

struct Variant {
  const char* name;
  PointRung rung;
  Mark mark;
};
constexpr Variant kVariants[] = {
    {"scatterers", {sim::Rung::scatterers, false}, Mark::disc},
    {"scatterers_side_lobes", {sim::Rung::scatterers, true}, Mark::triangle},
    {"reference", {sim::Rung::reference, false}, Mark::ring},
    {"field", {sim::Rung::field, false}, Mark::square}};

void add_checks(const std::string& name,
                const Variant& variant,
                std::span<const BeamComparison> found,
                StudyReport& report) {
  for (const StickPlaces places : {StickPlaces::axis, StickPlaces::edge}) {
    const bool axis = places == StickPlaces::axis;
    const auto here = at_places(found, places, kFrom_m, kTo_m);
    const std::string where = axis ? ".axis" : ".edge";
    const bool field = variant.rung.rung == sim::Rung::field;
    for (const BeamWidth& width : {kLateral, kElevation, kAxial}) {
      if (field && width.value == kAxial.value) continue;
      report.checks.push_back(
          worst_width(name + "." + width.name + where, here, width, axis ? kAxisBar : kEdgeBar));
    }
    if (field) continue;
    report.checks.push_back(worst_level(name + ".level" + where, here, kLevelBar_db));
  }
}

constexpr char kText[] =
    "One point on the axis of a stick, heard by sticks that turn past it in the image plane and "
    "by frames that turn past it about the motor's axis, at every depth, angle and preset of "
    "`tests/yardstick/point_widths.csv`. Widths are those at half amplitude (-6 dB), between "
    "the first places on either side of the maximum. `scatterers` (main lobe, and with side "
    "lobes) and `reference` hear the point by their own sums of echoes; `field` has no points: "
    "shown are the widths by which it blurs the edges of tissue, across lines against "
    "`stick_beam.csv`: the beam of one stick over places is what blurs them, and towards the "
    "array's "
    "end, where each stick has another aperture, it is narrower than what sticks that turn past "
    "a place make of it. A level is that of the stick "
    "through the point over the middle stick's at the same range, since both rungs are "
    "normalised to the middle stick at every range; how the level falls with range there is "
    "left out of both. A few sticks beyond the sector's edge are scanned where a profile needs "
    "them; the array ends where it does. Checks name the worst of the depths from 30 mm on: "
    "`axis`, the middle stick; `edge`, all others up to the last one.";

}  // namespace

StudyReport point_target_report() {
  StudyReport report;
  report.id = "points";
  report.title = "Point targets";
  for (const hw::ProbePreset preset : kPresets) {
    const std::string preset_name(table_name(preset));
    const auto places = point_width_rows(preset);
    std::vector<ChartedRung> rungs;
    for (const Variant& variant : kVariants) {
      const auto found = measure_points(preset, variant.rung, places);
      add_checks("points." + std::string(variant.name) + "." + preset_name, variant, found, report);
      add_points(std::string(variant.name) + " " + preset_name, found, report);
      rungs.push_back({variant.name, variant.mark, found});
    }
    report.figures.push_back(widths_figure("points", "one point's echo", preset, rungs));
  }
  report.text = kText;
  return report;
}

}  // namespace wobblebench::bench
