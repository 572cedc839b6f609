#include <algorithm>

#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

std::string file_name(std::string name) {
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

Figure draw_part(const TradeResults::Part& part) {
  Chart chart{"Time and error: " + part.name,
              {"picture of a new volume / the reference's", Scale::logarithmic},
              {"depth error, P95 (mm)", Scale::logarithmic}};
  Series all{"points", {}, {}, Stroke::none, Mark::disc, 4};
  for (const TradeScore& score : part.scores) {
    all.x.push_back(score.volume_ratio);
    all.y.push_back(score.p95_mm());
  }
  Series front{"front: time, P95, missed or false", {}, {}, Stroke::none, Mark::square, 0};
  for (const std::size_t i : part.front) {
    front.x.push_back(part.scores[i].volume_ratio);
    front.y.push_back(part.scores[i].p95_mm());
  }
  Series knees{"knees", {}, {}, Stroke::solid, Mark::diamond, 1};
  for (const TradeKnee& knee : part.knees) {
    knees.x.push_back(part.scores[knee.score].volume_ratio);
    knees.y.push_back(part.scores[knee.score].p95_mm());
  }
  chart.series = {all, front};
  if (!knees.x.empty()) chart.series.push_back(knees);
  return {file_name(part.name),
          "Every point on " + part.name + ", and the front of time, P95 and missed or false.",
          draw(chart, {760, 460})};
}

}  // namespace

std::vector<Figure> trade_figures(const TradeResults& results) {
  std::vector<Figure> figures;
  for (const TradeResults::Part& part : results.parts) {
    if (!part.front.empty()) figures.push_back(draw_part(part));
  }
  return figures;
}

std::string trade_figure_file(const Figure& figure) {
  return "trade_" + figure.name + ".png";
}

}  // namespace wobblebench::bench
