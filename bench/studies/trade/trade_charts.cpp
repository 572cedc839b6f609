#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/number_text.h"
#include "bench/output/document/interval_cells.h"
#include "bench/results/error.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;
using Part = TradeResults::Part;

/// What stands along the vertical axis of a panel.
struct Response {
  const char* title;
  const char* label;
  const Measure* measure;
};
constexpr Response kResponses[] = {{"Time against error", "depth error, P95 (mm)", &error::kP95},
                                   {"Time against surface missed or false",
                                    "missed or false (% of the picture)",
                                    &error::kMissedOrFalse}};

class FrontCharts {
 public:
  FrontCharts(const TradeResults& results, const Part& part)
      : results_(results), part_(part), named_(named_points(results.work, part.scenes.front())) {}

  Chart chart(const Response& response) const {
    const std::size_t measure = trade_measure(response.measure->key);
    Chart chart{.title = std::string(response.title) + ": " + part_.name,
                .x = {"time of a new volume / the reference's", Scale::logarithmic},
                .y = {response.label, scale_of(measure)}};
    const Kinds kinds = kinds_of_scores();
    for (const auto& [look, scores] : kinds) {
      if (!scores.empty()) chart.series.push_back(series(look, scores, measure));
    }
    fit(chart);
    return chart;
  }

 private:
  /// A logarithmic axis has no place for a picture without any fault.
  Scale scale_of(std::size_t measure) const {
    const bool has_zero =
        std::any_of(part_.scores.begin(), part_.scores.end(), [&](const TradeScore& score) {
          return score.measures[measure].mean <= 0;
        });
    return has_zero ? Scale::linear : Scale::logarithmic;
  }

  /// How each kind of score looks, and its numbers; each score is of one kind.
  using Kinds = std::vector<std::pair<Series, std::vector<std::size_t>>>;

  Kinds kinds_of_scores() const {
    Kinds kinds = {{{.name = "points", .mark = Mark::disc, .colour = 6}, {}},
                   {{.name = "front", .mark = Mark::square, .colour = 0}, {}},
                   {{.name = "knees", .mark = Mark::diamond, .colour = 1}, {}}};
    constexpr Mark kMarks[] = {Mark::triangle, Mark::ring};
    for (const NamedPoint& named : named_) {
      const int colour = static_cast<int>(kinds.size()) - 1;
      const std::string but = named.differs_in.empty() ? "" : ", but " + named.differs_in;
      const Mark mark = kMarks[kinds.size() % std::size(kMarks)];
      kinds.push_back({{.name = named.name + but, .mark = mark, .colour = colour}, {}});
    }
    for (std::size_t i = 0; i < part_.scores.size(); ++i) kinds[kind_of(i)].second.push_back(i);
    return kinds;
  }

  /// Number of the kind of a score.
  std::size_t kind_of(std::size_t score) const {
    constexpr std::size_t kPoint = 0, kFront = 1, kKnee = 2, kFirstNamed = 3;
    for (std::size_t n = 0; n < named_.size(); ++n) {
      if (named_[n].point == part_.scores[score].point) return kFirstNamed + n;
    }
    const bool is_knee = std::any_of(part_.knees.begin(),
                                     part_.knees.end(),
                                     [&](const TradeKnee& knee) { return knee.score == score; });
    if (is_knee) return kKnee;
    const auto& front = part_.front;
    return std::find(front.begin(), front.end(), score) != front.end() ? kFront : kPoint;
  }

  /// All but the many other points have their intervals.
  Series series(Series look, const std::vector<std::size_t>& scores, std::size_t measure) const {
    const bool with_intervals = look.name != "points";
    look.stroke = Stroke::none;
    for (const std::size_t i : scores) {
      const TradeScore& score = part_.scores[i];
      const MeanInterval& value = score.measures[measure];
      look.add(score.volume_ratio, value.mean);
      look.ids.push_back(point_id(score.point));
      look.notes.push_back("point " + std::to_string(score.point) + ": " +
                           point_text(results_.work, score.point));
      if (!with_intervals) continue;
      look.low.push_back(value.mean - value.half);
      look.high.push_back(value.mean + value.half);
    }
    return look;
  }

  /// Logarithmic axes end at the points, not at powers of ten.
  static void fit(Chart& chart) {
    std::vector<double> x, y;
    for (const Series& series : chart.series) {
      x.insert(x.end(), series.x.begin(), series.x.end());
      for (const auto* values : {&series.y, &series.low, &series.high}) {
        y.insert(y.end(), values->begin(), values->end());
      }
    }
    fit(x, chart.x);
    fit(y, chart.y);
  }

  static void fit(std::vector<double> values, Axis& axis) {
    constexpr double kMargin = 1.15;
    std::erase_if(values, [](double value) { return !std::isfinite(value) || value <= 0; });
    if (axis.scale == Scale::linear || values.empty()) return;
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    axis.low = *least / kMargin;
    axis.high = *most * kMargin;
  }

  const TradeResults& results_;
  const Part& part_;
  std::vector<NamedPoint> named_;
};

/// An axis' value in a scene, as a point writes it; empty: the scene has no such key.
std::string value_in(const Json& scene, const std::string& key) {
  std::string path = "/" + key;
  std::replace(path.begin(), path.end(), '.', '/');
  const Json::json_pointer place(path);
  if (!scene.contains(place)) return "";
  const Json& value = scene.at(place);
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Numbers by value; of a range, values as near as a hundredth of it are equal.
bool is_same_value(const TradeAxis& axis, const std::string& value, const std::string& wanted) {
  const auto number_of = [](const std::string& text) {
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    return end == text.c_str() || *end != '\0' ? std::nan("") : number;
  };
  const double a = number_of(value), b = number_of(wanted);
  if (std::isnan(a) || std::isnan(b)) return plain_value(value) == wanted;
  constexpr double kNear = 0.01;
  const double allowed = axis.range ? kNear * (axis.range->to - axis.range->from) : 0;
  return std::abs(a - b) <= allowed;
}

/// The axes in which a point differs from the wanted values.
std::vector<std::string> differing_axes(const TradeWork& work,
                                        const TradePoint& point,
                                        const std::vector<std::string>& wanted) {
  std::vector<std::string> differing;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const TradeAxis& axis = work.plan.axes[i];
    if (is_same_value(axis, point.values[i], wanted[i])) continue;
    differing.push_back(axis.key.substr(axis.key.rfind('.') + 1));
  }
  return differing;
}

/// The point that is the scene's setting or differs from it in one axis.
std::optional<NamedPoint> nearest_point(const TradeWork& work,
                                        const std::string& name,
                                        const Scene& scene) {
  const Json all = resolved(scene);
  std::vector<std::string> wanted;
  for (const TradeAxis& axis : work.plan.axes) wanted.push_back(value_in(all, axis.key));
  std::optional<NamedPoint> nearest;
  for (std::size_t point = 0; point < work.points.size(); ++point) {
    const auto differing = differing_axes(work, work.points[point], wanted);
    if (differing.empty()) return NamedPoint{name, point, ""};
    if (differing.size() == 1 && !nearest) nearest = NamedPoint{name, point, differing.front()};
  }
  return nearest;
}

/// Points of which a page has details besides those of a front: each takes about a kilobyte.
constexpr std::size_t kMostDetails = 2000;

std::set<std::size_t> points_with_details(const TradeResults& results) {
  std::set<std::size_t> points;
  for (const Part& part : results.parts) {
    for (const std::size_t i : part.front) points.insert(part.scores[i].point);
    if (part.scores.size() > kMostDetails) continue;
    for (const TradeScore& score : part.scores) points.insert(score.point);
  }
  return points;
}

std::string measured_text(const Part& part, std::size_t point) {
  const auto found = std::find_if(part.scores.begin(),
                                  part.scores.end(),
                                  [&](const TradeScore& score) { return score.point == point; });
  if (found == part.scores.end()) return "- " + part.name + ": refused\n";
  const auto text = [&](const Measure& measure) {
    return interval_cell(found->measures[trade_measure(measure.key)]).shown(column_of(measure));
  };
  return "- " + part.name + ": " + fixed(found->volume_ratio, 2) + " of the reference's time (" +
         fixed(found->volume_ms, 0) + " ms), P95 " + text(error::kP95) + " mm, missed " +
         text(error::kMissed) + " %, false " + text(error::kFalse) + " %\n";
}

/// What the front's intervals are over; one seed gives none.
std::string intervals_text(std::size_t seeds) {
  if (seeds < 2) return "";
  return "; the front with 95 % intervals over " + std::to_string(seeds) + " seeds";
}

}  // namespace

std::string point_id(std::size_t point) {
  return "point-" + std::to_string(point);
}

std::vector<NamedPoint> named_points(const TradeWork& work, std::size_t scene) {
  std::vector<NamedPoint> named;
  const auto add = [&](const std::string& name, const std::vector<std::string>& settings) {
    const auto options = work.without_point(scene, settings);
    if (!options) return;
    if (const auto point = nearest_point(work, name, *options)) named.push_back(*point);
  };
  add("defaults", {});
  add("paper's setting", {"render.preset=\"baseline\""});
  return named;
}

Figure trade_figure(const TradeResults& results, const TradeResults::Part& part) {
  Figure figure{.name = part.file(),
                .caption = "Every point on " + part.name +
                           ", and the front of time, P95 and missed or false together" +
                           intervals_text(results.work.plan.seeds.size()) + "."};
  const FrontCharts charts(results, part);
  for (const Response& response : kResponses) figure.panels.emplace_back(charts.chart(response));
  return figure;
}

std::vector<Detail> trade_details(const TradeResults& results, const TradePictures& pictures) {
  std::vector<Detail> details;
  for (const std::size_t point : points_with_details(results)) {
    Detail detail{.id = point_id(point), .title = "Point " + std::to_string(point)};
    detail.command = results.work.run_command(0, point);
    detail.text = "The command makes its picture on scene " +
                  results.work.plan.scenes.front().name + ", seed " +
                  std::to_string(results.work.plan.seeds.front()) + ".\n\n";
    for (const Part& part : results.parts) detail.text += measured_text(part, point);
    detail.text.append("\n").append(point_text(results.work, point)).append("\n");
    const auto picture = pictures.find(point);
    if (picture != pictures.end()) detail.picture_file = picture->second;
    details.push_back(std::move(detail));
  }
  return details;
}

}  // namespace wobblebench::bench
