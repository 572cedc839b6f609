// The trade of a plan, as trade.md, trade.csv, report.json and a figure.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/output/document/chart.h"
#include "bench/output/report_parts.h"
#include "bench/studies/trade/trade_analysis.h"

namespace wobblebench::bench {

/// Everything that a report says, computed from the records once.
struct TradeResults {
  TradeWork work;
  TradeRecords records;  ///< one for every unit
  std::set<std::string> machines;
  struct Part {
    std::string name;  ///< a scene's, or "all scenes"
    std::vector<TradeScore> scores;
    std::vector<std::size_t> front;
    std::vector<TradeKnee> knees;
  };
  std::vector<Part> parts;    ///< all scenes first, if there are several
  std::size_t refused = 0;    ///< points that at least one scene refused
  std::string first_refusal;  ///< why; empty: none was
};

/// `content`: records of every unit.
TradeResults trade_results(TradeWork work, TradeContent content);

/// A row for each unit, in their order, refused ones too.
std::string trade_csv(const TradeResults& results);
std::string trade_markdown(const TradeResults& results);
nlohmann::ordered_json trade_json(const TradeResults& results);
/// A point's settings, times and measures.
nlohmann::ordered_json trade_score_json(const TradeWork& work, const TradeScore& score);
/// Time against P95 of a part, with its front; none of a part without a front.
std::optional<Figure> trade_figure(const TradeResults::Part& part);

/// "commit 0123456789ab, CPU, 2 threads, GL_RENDERER": what measured.
std::string measured_by(const Provenance& provenance);

/// The axes in which a point differs from another, "steps 256, detector iso"; without `from` all.
std::string point_text(const TradeWork& work, std::size_t point, const std::size_t* from = nullptr);

}  // namespace wobblebench::bench
