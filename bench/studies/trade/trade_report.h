// The trade of a plan, as a document, trade.csv and report.json.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/output/report_parts.h"
#include "bench/studies/trade/trade_analysis.h"

namespace wobblebench::bench {

/// Everything that a report says, computed from the records once.
struct TradeResults {
  TradeWork work;
  TradeRecords records;  ///< one for every unit
  std::set<std::string> machines;
  struct Part {
    std::string name;                 ///< a scene's, or "all scenes"
    std::vector<std::size_t> scenes;  ///< numbers of the plan
    std::vector<TradeScore> scores;
    std::vector<std::size_t> front;
    std::vector<TradeKnee> knees;

    /// The name as a part of the names of files.
    std::string file() const;
  };
  std::vector<Part> parts;    ///< all scenes first, if there are several
  std::size_t refused = 0;    ///< points that at least one scene refused
  std::string first_refusal;  ///< why; empty: none was
};

/// `content`: records of every unit.
TradeResults trade_results(TradeWork work, TradeContent content);

/// Files of pictures of points on the first scene, by the points' numbers.
using TradePictures = std::map<std::size_t, std::string>;

/// Fronts with charts, knees, effects of settings, and trade.csv.
Document trade_document(const TradeResults& results, const TradePictures& pictures);

/// A row for each unit, in their order, refused ones too.
Table trade_rows(const TradeResults& results);
nlohmann::ordered_json trade_json(const TradeResults& results);
/// A point's settings, times and measures.
nlohmann::ordered_json trade_score_json(const TradeWork& work, const TradeScore& score);

/// Time against P95 and against what is missed or false: all points of a part, its front, its
/// knees, and the default setting and the paper's where they are among the points or near.
Figure trade_figure(const TradeResults& results, const TradeResults::Part& part);
/// What a click on a point shows, of each point that a chart has.
std::vector<Detail> trade_details(const TradeResults& results, const TradePictures& pictures);

/// A setting that has a name, and the point that is that setting, or differs from it in one axis.
struct NamedPoint {
  std::string name;
  std::size_t point = 0;
  std::string differs_in;  ///< the axis; empty: none
};
/// The program's defaults and the preset "baseline", as a scene of the plan sets the rest.
std::vector<NamedPoint> named_points(const TradeWork& work, std::size_t scene);

/// "point-17": in charts, tables and details.
std::string point_id(std::size_t point);

/// "commit 0123456789ab, CPU, 2 threads, GL_RENDERER": what measured.
std::string measured_by(const Provenance& provenance);

/// The axes in which a point differs from another, "steps 256, detector iso"; without `from` all.
std::string point_text(const TradeWork& work, std::size_t point, const std::size_t* from = nullptr);

}  // namespace wobblebench::bench
