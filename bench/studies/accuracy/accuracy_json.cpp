#include <nlohmann/json.hpp>

#include "bench/output/report_parts.h"
#include "bench/studies/accuracy/accuracy_report.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// Measures that no seed has are left out.
Json intervals_json(const std::vector<MeanInterval>& intervals) {
  Json json = Json::object();
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const MeanInterval& interval = intervals[i];
    if (interval.n == 0) continue;
    json[measure_names()[i]] = {
        {"mean", interval.mean}, {"half_interval", number(interval.half)}, {"n", interval.n}};
  }
  return json;
}

}  // namespace

Json accuracy_json(const AccuracyResults& results) {
  Json summaries = Json::array();
  for (const AccuracySummary& summary : results.summaries) {
    Json json = {{"scene", summary.scene},
                 {"rung", summary.rung},
                 {"setting", summary.setting},
                 {"group", summary.group},
                 {"region", summary.region},
                 {"means", intervals_json(summary.means)}};
    if (!summary.differences.empty()) {
      json["differences"] = intervals_json(summary.differences);
    }
    if (summary.group == "picture") json["render_ms"] = number(summary.render_ms.mean);
    summaries.push_back(std::move(json));
  }
  const EvaluationTimes& times = results.times;
  return {{"seeds", results.seeds},
          {"notes", results.notes},
          {"evaluations", results.evaluations},
          {"evaluation_ms",
           {{"renderer", times.renderer_ms},
            {"render", times.render_ms},
            {"truth", times.truth_ms},
            {"measure", times.measure_ms}}},
          {"summaries", summaries}};
}

}  // namespace wobblebench::bench
