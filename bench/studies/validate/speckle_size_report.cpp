#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/number_text.h"
#include "bench/studies/validate/study_reports.h"
#include "bench/studies/validate/table_comparison.h"

namespace wobblebench::bench {

namespace {

constexpr double kFrom_m = 20e-3, kTo_m = 150e-3;
constexpr double kWidthBar = 10;  // percent
constexpr double kLevelBar_db = 0.5;
constexpr double kErrorBar = 3;  // percent
constexpr double kNeighbourBar = 0.05;

/// The main lobe alone is not what the table is of, and its speckle is finer: it is shown beside
/// the table, without a bar.
bool widths_checked(const SpeckleRung& variant) {
  return variant.rung != sim::Rung::scatterers || variant.side_lobes;
}

/// One size of one variant: its checks, or rows of the table that shows what it leaves out.
struct Reported {
  std::string name;
  bool widths_checked;
  std::vector<std::uint64_t> seeds;
  StudyReport& report;
  std::ostream& price;
};

void add_places(const SpeckleSize& size, StickPlaces places, const Reported& to) {
  const CheckedOver over{"places", to.seeds};
  const std::string where = places == StickPlaces::axis ? ".axis" : ".edge";
  const auto here = at_places(size.places, places, kFrom_m, kTo_m);
  for (const BeamWidth& width : {kLateral, kElevation, kAxial}) {
    const Check check =
        worst_width(to.name + "." + width.name + where, here, width, kWidthBar, over);
    if (to.widths_checked) {
      to.report.checks.push_back(check);
    } else {
      to.price << "| `" << check.name << "` | " << significant(check.measured, 3) << " % | "
               << check.source << " |\n";
    }
  }
  to.report.checks.push_back(worst_level(to.name + ".level" + where, here, kLevelBar_db, over));
}

void add_size(const SpeckleSize& size, const Reported& to) {
  add_places(size, StickPlaces::axis, to);
  add_places(size, StickPlaces::edge, to);
  to.report.checks.push_back({to.name + ".standard_error",
                              Check::Kind::at_most,
                              100 * *std::ranges::max_element(size.relative_error),
                              kErrorBar,
                              0,
                              "%",
                              "of a width by chance, from the seeds' spread, root mean square over "
                              "the places, of the worst direction",
                              static_cast<long>(size.places.size()),
                              "places",
                              to.seeds});
}

Check neighbour_check(const std::string& name,
                      const std::vector<NeighbourRow>& found,
                      double NeighbourRow::*value,
                      const std::vector<std::uint64_t>& seeds) {
  const auto table = neighbour_rows();
  std::size_t worst = 0;
  const auto error = [&](std::size_t i) { return std::abs(found[i].*value - table[i].*value); };
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (error(i) > error(worst)) worst = i;
  }
  return {name,
          Check::Kind::at_most,
          error(worst),
          kNeighbourBar,
          0,
          "1",
          "worst at " + std::to_string(std::lround(table[worst].range_m * 1e3)) +
              " mm: " + fixed(found[worst].*value, 3) + ", table " + fixed(table[worst].*value, 3),
          static_cast<long>(table.size()),
          "depths",
          seeds};
}

void add_neighbours(const SpeckleRung& variant,
                    const NeighbourInputs& inputs,
                    StudyReport& report) {
  const auto found = measure_neighbours(variant.rung, variant.side_lobes, inputs);
  const auto table = neighbour_rows();
  const std::string name = std::string("speckle_size.") + variant.name;
  report.checks.push_back(neighbour_check(
      name + ".neighbouring_lines", found, &NeighbourRow::line_correlation, inputs.seeds));
  report.checks.push_back(neighbour_check(
      name + ".neighbouring_frames", found, &NeighbourRow::frame_correlation, inputs.seeds));
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto add = [&](const std::string& what, double NeighbourRow::*value) {
      report.points.push_back({std::string(variant.name) + " default scan",
                               "range_mm",
                               table[i].range_m * 1e3,
                               what,
                               found[i].*value,
                               table[i].*value});
    };
    add("neighbouring_lines_correlation", &NeighbourRow::line_correlation);
    add("neighbouring_frames_correlation", &NeighbourRow::frame_correlation);
  }
}

constexpr char kText[] =
    "Even tissue without losses, scanned densely in one direction and sparsely in the others: "
    "the full width at half maximum of the normalised autocovariance of the intensity across "
    "lines, across frames and along the stick, and the mean echo power, at the places of "
    "`tests/yardstick/speckle.csv`. Of fully developed speckle the autocovariance is the "
    "squared magnitude of the correlation of two sticks' fields, which the yardstick integrates "
    "over the scatterers' places. Out of focus the beam is wide, but its phase is curved: "
    "speckle stays as fine as the aperture makes it. Widths are means over 5 mm of range about "
    "each depth; across lines, of pairs of sticks whose middle is within 0.3 degrees of the place: "
    "towards the array's end speckle doubles within 5 degrees. A level is over the material's mean "
    "echo; the table's is over the middle stick "
    "at the same range, to which both rungs are normalised. Neighbours: the default scan, 64 "
    "lines over 77 degrees and 37 frames over 61, correlation of intensities with the next line "
    "and the next frame, the middle 16 lines (`tests/yardstick/neighbours.csv`). Checks name "
    "the worst of the depths from 20 to 150 mm: `axis`, the middle stick; `edge`, all others up "
    "to the last one. A few degrees beyond it are scanned too; the array ends where it does.\n\n"
    "The table is of the whole beam, and so is `scatterers_side_lobes` (`simulation.side_lobes`). "
    "`scatterers` without it hears what lies within the search edge of decision 10 alone. Speckle "
    "is then finer, most at the foci: the share of the aperture's spatial frequencies that only "
    "far "
    "scatterers tell apart is missing. Its levels are checked; its widths, of which there is no "
    "independent table, are shown without a bar, as what switching side lobes off costs:\n\n"
    "| size, main lobe alone | farthest from the table of the whole beam | |\n"
    "| --- | ---: | --- |\n";

void add_preset(hw::ProbePreset preset, std::ostream& price, StudyReport& report) {
  const std::string preset_name(table_name(preset));
  const auto places = speckle_rows(preset);
  std::vector<ChartedRung> rungs;
  for (const SpeckleRung& variant : kSpeckleRungs) {
    SpeckleSizeInputs inputs;
    inputs.preset = preset;
    inputs.rung = variant.rung;
    inputs.side_lobes = variant.side_lobes;
    const SpeckleSize size = measure_speckle_size(inputs, places);
    const std::string name = variant.name;
    add_size(size,
             {"speckle_size." + name + "." + preset_name,
              widths_checked(variant),
              inputs.seeds,
              report,
              price});
    add_points(name + " " + preset_name, size.places, report);
    rungs.push_back({name, variant.mark, size.places});
  }
  report.figures.push_back(widths_figure("speckle_size", "speckle", preset, rungs));
}

}  // namespace

StudyReport speckle_size_report() {
  StudyReport report;
  report.id = "speckle_size";
  report.title = "Size of speckle";
  std::ostringstream price;
  for (const hw::ProbePreset preset : kPresets) add_preset(preset, price, report);
  for (const SpeckleRung& variant : kSpeckleRungs) add_neighbours(variant, {}, report);
  report.text = kText + price.str();
  return report;
}

}  // namespace wobblebench::bench
