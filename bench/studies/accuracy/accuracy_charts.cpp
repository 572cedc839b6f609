#include "bench/studies/accuracy/accuracy_charts.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "bench/results/error.h"

namespace wobblebench::bench {

Chosen picture_columns() {
  static constexpr const Measure* kShown[] = {&error::kMedian,
                                              &error::kRms,
                                              &error::kP95,
                                              &error::kOutliers,
                                              &error::kMissed,
                                              &error::kMissedSurface,
                                              &error::kFalse,
                                              &error::kFalseSurface,
                                              &error::kGrazingMissed,
                                              &error::kNormalMedian,
                                              &error::kDistanceMean,
                                              &error::kHausdorff95,
                                              &error::kSsim};
  return kShown;
}

std::string id_of(const AccuracySummary& s) {
  return s.scene + "-" + s.rung + "-" + s.setting;
}

namespace {

/// Each value once, in the order of the summaries.
std::vector<std::string> different(const AccuracyResults& results,
                                   std::string AccuracySummary::*name) {
  std::vector<std::string> values;
  for (const AccuracySummary& s : results.summaries) {
    if (std::find(values.begin(), values.end(), s.*name) == values.end()) values.push_back(s.*name);
  }
  return values;
}

/// Charts of one rung: settings along the axis and a series for each scene, or the other way round
/// where there is one setting alone.
class RungCharts {
 public:
  RungCharts(const AccuracyResults& results, std::string rung)
      : results_(results), rung_(std::move(rung)) {
    if (different(results, &AccuracySummary::setting).size() < 2) std::swap(along_, apart_);
    names_ = different(results, along_);
  }

  Figure figure() const {
    const std::size_t seeds = results_.seeds.size();
    const bool of_settings = along_ == &AccuracySummary::setting;
    Figure figure{
        .name = "errors_" + rung_,
        .caption =
            std::string("Errors by ") + (of_settings ? "setting and scene" : "scene") + ", rung " +
            rung_ +
            (results_.of_population ? ": means over the scenes of each with 95 % intervals."
             : seeds > 1 ? ": means over " + std::to_string(seeds) + " seeds with 95 % intervals."
                         : ", of one seed.")};
    for (const Measure* measure :
         {&error::kMedian, &error::kP95, &error::kMissed, &error::kFalse}) {
      figure.panels.emplace_back(chart(*measure));
    }
    return figure;
  }

 private:
  Chart chart(const Measure& measure) const {
    const Column column = column_of(measure);
    const bool of_depth = column.unit == "mm";
    Chart chart{
        .title = of_depth ? "Depth error, " + column.title : "Surface that is " + column.title,
        .x = {.label = along_ == &AccuracySummary::setting ? "setting" : "scene", .names = names_},
        .y = {.label = column.title + (of_depth ? " (mm)" : " (% of the picture)")}};
    const double least = of_depth ? -std::numeric_limits<double>::infinity() : 0;
    if (!of_depth) chart.y.low = least;
    const auto all = different(results_, apart_);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double apart = std::min(kMostApart, kRoom / static_cast<double>(all.size()));
      const double offset = apart * (static_cast<double>(i) - 0.5 * (double(all.size()) - 1));
      chart.series.push_back(series(all[i], measure_index(measure.key), offset, least));
      chart.series.back().mark = kMarks[i % std::size(kMarks)];
    }
    if (!of_depth && shows_zeros_alone(chart)) chart.y.high = 1;
    return chart;
  }

  static bool shows_zeros_alone(const Chart& chart) {
    return std::all_of(chart.series.begin(), chart.series.end(), [](const Series& series) {
      return std::none_of(series.y.begin(), series.y.end(), [](double y) { return y > 0; });
    });
  }

  /// No end of an interval is less than `least`.
  Series series(const std::string& name, std::size_t measure, double offset, double least) const {
    Series series{.name = name, .stroke = Stroke::none};
    for (const AccuracySummary& s : results_.summaries) {
      if (s.group != "picture" || s.rung != rung_ || s.*apart_ != name) continue;
      const auto at = std::find(names_.begin(), names_.end(), s.*along_) - names_.begin();
      const MeanInterval& value = s.means[measure];
      series.add(static_cast<double>(at) + offset, value.mean);
      series.low.push_back(std::max(least, value.mean - value.half));
      series.high.push_back(value.mean + value.half);
      series.ids.push_back(id_of(s));
    }
    return series;
  }

  static constexpr double kMostApart = 0.12, kRoom = 0.8;
  static constexpr Mark kMarks[] = {Mark::disc, Mark::square, Mark::triangle, Mark::diamond};

  const AccuracyResults& results_;
  std::string rung_;
  std::string AccuracySummary::*along_ = &AccuracySummary::setting;
  std::string AccuracySummary::*apart_ = &AccuracySummary::scene;
  std::vector<std::string> names_;
};

}  // namespace

std::vector<Figure> accuracy_figures(const AccuracyResults& results) {
  std::vector<Figure> figures;
  for (const std::string& rung : different(results, &AccuracySummary::rung)) {
    figures.push_back(RungCharts(results, rung).figure());
  }
  return figures;
}

}  // namespace wobblebench::bench
