#include "bench/studies/validate/speckle_size.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "base/number_text.h"
#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/speckle_grid.h"
#include "bench/studies/validate/speckle_statistics.h"
#include "bench/studies/validate/study_report.h"

namespace wobblebench::bench {

namespace {

constexpr double kDepth_m = 0.165;
constexpr int kSamples = 1500;  // IQ samples then need no oversampling
/// Towards the end of the array speckle doubles within some degrees.
constexpr double kAboutStick_rad = 0.3 * kDegree;
/// Lags are measured until the covariance is well below a half.
constexpr double kEnough = 0.4;
constexpr int kMostLags = 60;

/// Sticks about a place: in the dense direction a quarter of the width apart or less, in the others
/// about the width or more.
struct DenseGrid {
  GridPlan plan;
  ScanStep step;
  double about_middle_rad = HUGE_VAL;
};

DenseGrid dense_grid(BeamDirection direction) {
  switch (direction) {
    case BeamDirection::axial:
      return {{0, 3, 1.2 * kDegree, 48, 1.7 * kDegree, kDepth_m, 4096}, {0, 0, 1}};
    case BeamDirection::lateral:
      return {{0, 21, 0.25 * kDegree, 96, 0.85 * kDegree, kDepth_m, kSamples},
              {0, 1, 0},
              kAboutStick_rad};
    case BeamDirection::elevation:
      return {{0, 2, 2.4 * kDegree, 320, 0.19 * kDegree, kDepth_m, kSamples}, {1, 0, 0}};
  }
  throw std::logic_error("BeamDirection: no such direction");
}

/// Between neighbours in the dense direction.
double step_m(BeamDirection direction,
              const GridPlan& plan,
              const hw::ProbeGeometry& geometry,
              const BeamRow& place) {
  const double radius_m = geometry.radius_m() + place.range_m;
  switch (direction) {
    case BeamDirection::axial:
      return plan.depth_m / plan.samples;
    case BeamDirection::lateral:
      return radius_m * plan.theta_step_rad;
    case BeamDirection::elevation:
      return (radius_m * std::cos(place.theta_rad) - geometry.axis_z_m()) * plan.phi_step_rad;
  }
  throw std::logic_error("BeamDirection: no such direction");
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

/// Of one seed: the covariance at lags 1, 2, ... until it is low.
std::vector<double> covariances(const SpeckleGrid& grid,
                                const ScanWindow& window,
                                const ScanStep& step) {
  std::vector<double> values;
  for (int lag = 1; lag <= kMostLags && (values.empty() || values.back() > kEnough); ++lag) {
    values.push_back(intensity_correlation(grid, window, times(step, lag)));
  }
  return values;
}

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

double root_mean_square(const std::vector<SpeckleWidth>& widths) {
  std::vector<double> errors;
  for (const SpeckleWidth& width : widths) errors.push_back(width.relative_error);
  return wobblebench::root_mean_square(errors);
}

}  // namespace

std::vector<SpeckleWidth> measure_speckle_widths(BeamDirection direction,
                                                 const SpeckleSizeInputs& inputs,
                                                 std::span<const BeamRow> places) {
  const DenseGrid dense = dense_grid(direction);
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
                         step_m(direction, dense.plan, geometry, places[at]),
                         of_seeds);
  });
  return found;
}

SpeckleSize measure_speckle_size(const SpeckleSizeInputs& inputs, std::span<const BeamRow> places) {
  const auto lateral = measure_speckle_widths(BeamDirection::lateral, inputs, places);
  const auto elevation = measure_speckle_widths(BeamDirection::elevation, inputs, places);
  const auto axial = measure_speckle_widths(BeamDirection::axial, inputs, places);
  SpeckleSize size;
  for (std::size_t i = 0; i < places.size(); ++i) {
    BeamRow found = places[i];
    found.lateral_m = lateral[i].fwhm_m;
    found.elevation_m = elevation[i].fwhm_m;
    found.axial_m = axial[i].fwhm_m;
    found.level_db = lateral[i].level_db;
    size.places.push_back({places[i], found});
  }
  size.relative_error[0] = root_mean_square(lateral);
  size.relative_error[1] = root_mean_square(elevation);
  size.relative_error[2] = root_mean_square(axial);
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
  to.report.check(to.name + ".standard_error")
      .at_most(100 * *std::ranges::max_element(size.relative_error), kErrorBar, "%")
      .from(
          "of a width by chance, from the seeds' spread, root mean square over "
          "the places, of the worst direction")
      .over(static_cast<long>(size.places.size()), "places", to.seeds);
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
      report.point(std::string(variant.name) + " default scan",
                   {"range_mm", table[i].range_m * 1e3},
                   {what, found[i].*value, table[i].*value});
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
