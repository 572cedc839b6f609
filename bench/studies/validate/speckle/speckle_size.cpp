#include "bench/studies/validate/speckle/speckle_size.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/study_report.h"
#include "bench/studies/validate/speckle/speckle_grid.h"
#include "bench/studies/validate/speckle/speckle_statistics.h"

namespace wobblebench::bench {

namespace {

constexpr double kSizeDepth_m = 0.165;
constexpr int kSamples = 1500;  // IQ samples then need no oversampling
/// Towards the end of the array speckle doubles within some degrees.
constexpr double kAboutStick_rad = 0.3 * kDegree;
/// Lags are measured until the covariance is well below a half.
constexpr double kEnough = 0.4;
constexpr int kMostLags = 60;

/// Sticks about a stick angle: in the direction of the width a quarter of it apart or less, in the
/// others about the width or more.
struct DenseGrid {
  double BeamRow::*width;
  GridPlan plan;
  ScanStep step;
  double about_middle_rad = HUGE_VAL;
};
const DenseGrid kDenseGrids[] = {
    {&BeamRow::lateral_m,
     {0, 21, 0.25 * kDegree, 96, 0.85 * kDegree, kSizeDepth_m, kSamples},
     {0, 1, 0},
     kAboutStick_rad},
    {&BeamRow::elevation_m,
     {0, 2, 2.4 * kDegree, 320, 0.19 * kDegree, kSizeDepth_m, kSamples},
     {1, 0, 0}},
    {&BeamRow::axial_m, {0, 3, 1.2 * kDegree, 48, 1.7 * kDegree, kSizeDepth_m, 4096}, {0, 0, 1}}};

/// Distance between neighbours in the dense direction.
double step_m(const DenseGrid& dense, const hw::ProbeGeometry& geometry, const BeamRow& place) {
  const double radius_m = geometry.radius_m() + place.range_m;
  if (dense.step.samples > 0) return dense.plan.depth_m / dense.plan.samples;
  if (dense.step.lines > 0) return radius_m * dense.plan.theta_step_rad;
  return (radius_m * std::cos(place.theta_rad) - geometry.axis_z_m()) * dense.plan.phi_step_rad;
}

ScanStep times(const ScanStep& step, int lag) {
  return {step.frames * lag, step.lines * lag, step.samples * lag};
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

/// Standard error of the mean over the mean.
double relative_error(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values) squares += (value - mean(values)) * (value - mean(values));
  const double n = static_cast<double>(values.size());
  return std::sqrt(squares / (n - 1) / n) / mean(values);
}

/// The covariance of one seed at lags 1, 2, ... until it is low.
std::vector<double> covariances(const SpeckleGrid& grid,
                                const ScanWindow& window,
                                const ScanStep& step) {
  std::vector<double> values;
  for (int lag = 1; lag <= kMostLags && (values.empty() || values.back() > kEnough); ++lag) {
    values.push_back(intensity_correlation(grid, window, times(step, lag)));
  }
  return values;
}

struct SpeckleWidth {
  double fwhm_m = 0;
  double level_db = 0;  ///< mean echo power over that of the material
  /// Standard error over the width, from the seeds' spread; itself uncertain: to be averaged over
  /// many points.
  double relative_error = 0;
};

SpeckleWidth width_at(const ScanWindow& window,
                      const ScanStep& step,
                      double lag_m,
                      const std::vector<const SpeckleGrid*>& grids) {
  std::vector<double> widths, powers;
  for (const SpeckleGrid* grid : grids) {
    widths.push_back(autocovariance_fwhm_m(covariances(*grid, window, step), lag_m));
    powers.push_back(mean_intensity(*grid, window));
  }
  return {mean(widths), level_over_material_db(mean(powers)), relative_error(widths)};
}

/// Full width at half maximum of the autocovariance of the intensity in one direction, one for each
/// of `places`.
std::vector<SpeckleWidth> measure_widths(const DenseGrid& dense,
                                         const SpeckleSizeInputs& inputs,
                                         std::span<const BeamRow> places) {
  const hw::ProbeGeometry geometry(hw::probe_preset(inputs.preset).probe);
  std::vector<GridPlan> plans;  // one for each angle
  std::vector<std::size_t> plan_of;
  for (const BeamRow& place : places) {
    if (plans.empty() || plans.back().theta_rad != place.theta_rad) {
      plans.push_back(dense.plan);
      plans.back().theta_rad = place.theta_rad;
    }
    plan_of.push_back(plans.size() - 1);
  }
  std::vector<std::vector<SpeckleGrid>> grids;  // [seed][angle]
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(inputs.rung, seed);
    options.side_lobes = inputs.side_lobes;
    grids.push_back(speckle_grids(inputs.preset, options, plans));
  }
  std::vector<SpeckleWidth> found(places.size());
  parallel_rows(static_cast<int>(places.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    std::vector<const SpeckleGrid*> of_seeds;
    for (const auto& of_seed : grids) of_seeds.push_back(&of_seed[plan_of[at]]);
    const double range_m = places[at].range_m, half_m = inputs.half_window_m;
    found[at] = width_at({range_m - half_m, range_m + half_m, dense.about_middle_rad},
                         dense.step,
                         step_m(dense, geometry, places[at]),
                         of_seeds);
  });
  return found;
}

}  // namespace

SpeckleSize measure_speckle_size(const SpeckleSizeInputs& inputs, std::span<const BeamRow> places) {
  SpeckleSize size;
  for (const BeamRow& place : places) size.places.push_back({place, place});
  for (const DenseGrid& dense : kDenseGrids) {
    const auto widths = measure_widths(dense, inputs, places);
    std::vector<double> errors;
    for (std::size_t i = 0; i < places.size(); ++i) {
      BeamRow& found = size.places[i].measured;
      found.*dense.width = widths[i].fwhm_m;
      if (dense.width == &BeamRow::lateral_m) found.level_db = widths[i].level_db;
      errors.push_back(widths[i].relative_error);
    }
    size.relative_error.push_back(root_mean_square(errors));
  }
  return size;
}

std::vector<NeighbourRow> measure_neighbours(sim::Rung rung,
                                             bool side_lobes,
                                             const NeighbourInputs& inputs) {
  // The steps of the default scan, 64 lines over 77 degrees and 37 frames over 61; about its
  // middle.
  const GridPlan plan{0, 16, 77.0 / 63 * kDegree, 37, 61.0 / 36 * kDegree, 0.165, 1500};
  std::vector<NeighbourRow> rows = neighbour_rows();
  for (NeighbourRow& row : rows) row.line_correlation = row.frame_correlation = 0;
  const double share = 1 / static_cast<double>(inputs.seeds.size());
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(rung, seed);
    options.side_lobes = side_lobes;
    const SpeckleGrid volume = speckle_grids(hw::ProbePreset::standard, options, {plan}).front();
    for (NeighbourRow& row : rows) {
      const ScanWindow window{row.range_m - inputs.half_window_m,
                              row.range_m + inputs.half_window_m};
      row.line_correlation += share * intensity_correlation(volume, window, {0, 1, 0});
      row.frame_correlation += share * intensity_correlation(volume, window, {1, 0, 0});
    }
  }
  return rows;
}

namespace {

constexpr double kSizeFrom_m = 20e-3, kSizeTo_m = 150e-3;
constexpr double kWidthBar = 10;  // percent
constexpr double kSizeLevelBar_db = 0.5;
constexpr double kErrorBar = 3;  // percent
constexpr double kNeighbourBar = 0.05;

/// Checks of one size, or rows of the table that shows what the main lobe leaves out.
void add_places(const std::string& name,
                const SpeckleSize& size,
                StickPlaces places,
                const std::vector<std::uint64_t>& seeds,
                bool widths_checked,
                StudyReport& report) {
  const CheckedOver over{"places", seeds};
  const std::string where = places == StickPlaces::axis ? ".axis" : ".edge";
  const auto here = at_places(size.places, places, kSizeFrom_m, kSizeTo_m);
  for (const BeamWidth& width : {kLateral, kElevation, kAxial}) {
    const Check check = worst_width(name + "." + width.name + where, here, width, kWidthBar, over);
    if (widths_checked) {
      report.checks.push_back(check);
    } else {
      report.tables.front().add({Cell::code(check.name), check.measured, check.source});
    }
  }
  report.checks.push_back(worst_level(name + ".level" + where, here, kSizeLevelBar_db, over));
}

/// The worst depth of one correlation.
void add_neighbour_check(const std::string& name,
                         const std::vector<NeighbourRow>& found,
                         double NeighbourRow::*value,
                         const std::vector<std::uint64_t>& seeds,
                         StudyReport& report) {
  const auto table = neighbour_rows();
  std::size_t worst = 0;
  const auto error = [&](std::size_t i) { return std::abs(found[i].*value - table[i].*value); };
  for (std::size_t i = 1; i < table.size(); ++i) {
    if (error(i) > error(worst)) worst = i;
  }
  report.check(name)
      .at_most(error(worst), kNeighbourBar, "1")
      .from("worst at " + std::to_string(std::lround(table[worst].range_m * 1e3)) +
            " mm: " + fixed(found[worst].*value, 3) + ", table " + fixed(table[worst].*value, 3))
      .over(static_cast<long>(table.size()), "depths", seeds);
}

constexpr char kText[] =
    "Uniform tissue without losses, scanned densely in one direction and sparsely in the others: "
    "the full width at half maximum of the normalised autocovariance of the intensity across "
    "lines, across frames and along the stick, and the mean echo power, at the points of "
    "`tests/yardstick/speckle.csv`. Of fully developed speckle the autocovariance is the squared "
    "magnitude of the correlation of two sticks' fields, which the yardstick integrates over the "
    "scatterers' positions. Out of focus the beam is wide, but its phase is curved: speckle stays "
    "as fine as the aperture makes it. Widths are means over 5 mm of range about each depth; "
    "across lines, of pairs of sticks whose middle is within 0.3 degrees of the place: towards the "
    "array's end speckle doubles within 5 degrees. A level is over the material's mean echo; the "
    "table's is over the middle stick at the same range, to which both rungs are normalised. "
    "Neighbours: the default scan, 64 lines over 77 degrees and 37 frames over 61, correlation of "
    "intensities with the next line and the next frame, the middle 16 lines "
    "(`tests/yardstick/neighbours.csv`). Checks name the worst of the depths from 20 to 150 mm: "
    "`axis`, the middle stick; `edge`, all others up to the last one. A few degrees beyond it are "
    "scanned too; the array ends where it does.\n\n"
    "The table is of the whole beam, and so is `scatterers_side_lobes` (`simulation.side_lobes`). "
    "`scatterers` without it has echoes from within the search edge of decision 10 alone. Speckle "
    "is then finer, most at the foci: the share of the aperture's spatial frequencies that only "
    "far scatterers tell apart is missing. Its levels are checked; its widths, of which there is "
    "no independent table, are shown without a bar, as what switching side lobes off costs.";

void add_sizes(hw::ProbePreset preset, StudyReport& report) {
  const std::string preset_name(table_name(preset));
  const auto places = speckle_rows(preset);
  std::vector<ChartedRung> rungs;
  for (const SpeckleRung& variant : kSpeckleRungs) {
    SpeckleSizeInputs inputs;
    inputs.preset = preset;
    inputs.rung = variant.rung;
    inputs.side_lobes = variant.side_lobes;
    const SpeckleSize size = measure_speckle_size(inputs, places);
    const std::string name = std::string("speckle_size.") + variant.name + "." + preset_name;
    // The main lobe alone is not what the table is of, and its speckle is finer.
    const bool checked = variant.rung != sim::Rung::scatterers || variant.side_lobes;
    add_places(name, size, StickPlaces::axis, inputs.seeds, checked, report);
    add_places(name, size, StickPlaces::edge, inputs.seeds, checked, report);
    report.check(name + ".standard_error")
        .at_most(100 * *std::ranges::max_element(size.relative_error), kErrorBar, "%")
        .from(
            "of a width by chance, from the seeds' spread, root mean square over the places, of "
            "the worst direction")
        .over(static_cast<long>(places.size()), "places", inputs.seeds);
    add_points(std::string(variant.name) + " " + preset_name, size.places, report);
    rungs.push_back({variant.name, variant.mark, size.places});
  }
  report.figures.push_back(widths_figure("speckle_size", "speckle", preset, rungs));
}

void add_neighbours(const SpeckleRung& variant, StudyReport& report) {
  const NeighbourInputs inputs;
  const auto found = measure_neighbours(variant.rung, variant.side_lobes, inputs);
  const auto table = neighbour_rows();
  constexpr auto kLines = &NeighbourRow::line_correlation;
  constexpr auto kFrames = &NeighbourRow::frame_correlation;
  const std::string name = std::string("speckle_size.") + variant.name + ".neighbouring_";
  add_neighbour_check(name + "lines", found, kLines, inputs.seeds, report);
  add_neighbour_check(name + "frames", found, kFrames, inputs.seeds, report);
  const std::string series = std::string(variant.name) + " default scan";
  for (std::size_t i = 0; i < table.size(); ++i) {
    const StudyReport::X range{"range_mm", table[i].range_m * 1e3};
    const auto add = [&](const std::string& what, double NeighbourRow::*value) {
      report.point(series, range, {what, found[i].*value, table[i].*value});
    };
    add("neighbouring_lines_correlation", kLines);
    add("neighbouring_frames_correlation", kFrames);
  }
}

}  // namespace

StudyReport speckle_size_report() {
  StudyReport report;
  report.text = kText;
  report.tables = {
      {.name = "main_lobe_sizes",
       .columns = {{"size", "size, main lobe alone"},
                   {"error_percent", "farthest from the table of the whole beam", "%", 3, true},
                   {"at"}}}};
  for (const hw::ProbePreset preset : kPresets) add_sizes(preset, report);
  for (const SpeckleRung& variant : kSpeckleRungs) add_neighbours(variant, report);
  return report;
}

}  // namespace wobblebench::bench
