#include "bench/studies/tables/tables_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

namespace {

void put_timing(Json& row, PipelineVariant variant, const Timing& timing) {
  const std::string name = to_string(variant);
  row[name + "_ms"] = timing.frame_ms.median;
  row[name + "_min_ms"] = timing.frame_ms.min;
  row[name + "_max_ms"] = timing.frame_ms.max;
  row[name + "_median_interval_ms"] = {{"low", timing.median_ms.low},
                                       {"high", timing.median_ms.high},
                                       {"coverage", timing.median_ms.coverage}};
  row[name + "_ratio"] = timing.ratio.median;
  row[name + "_ratio_quartiles"] = {timing.ratio.lower, timing.ratio.upper};
  for (const PassTiming& pass : timing.passes) {
    row[name + "_passes"].push_back({{"name", pass.name}, {"ms", pass.ms}});
  }
}

Json row_json(const MeasuredRow& measured) {
  Json row = {{"setting", measured.row.setting},
              {"paper_ms", measured.row.paper_ms},
              {"paper_ratio", measured.paper_ratio}};
  for (const auto& [variant, timing] : measured.timings) put_timing(row, variant, timing);
  row["speed_up"] = measured.speed_up();
  row["pass_speed_up"] = Json::object();
  for (const PassTiming& pass : measured.timings.at(PipelineVariant::fast).passes) {
    const auto times = measured.pass_speed_up(pass.name);
    row["pass_speed_up"][pass.name] = times ? Json(*times) : Json(nullptr);
  }
  return row;
}

Json table_json(const MeasuredTable& measured) {
  Json table = {
      {"id", measured.table.id}, {"title", measured.table.title}, {"rows", Json::array()}};
  for (const MeasuredRow& row : measured.rows) table["rows"].push_back(row_json(row));
  if (const auto& exponents = measured.exponents) {
    table["exponent_of_side"] = {
        {"paper", exponents->paper}, {"plain", exponents->plain}, {"fast", exponents->fast}};
  }
  return table;
}

Json stages_json(const std::vector<StageTimes>& stages) {
  Json json = Json::array();
  for (const StageTimes& times : stages) {
    json.push_back({{"settings", times.settings},
                    {"frames", times.frames},
                    {"frame_ms", times.frame_ms},
                    {"last_frame_ms", times.last_frame_ms},
                    {"picture_ms", times.picture_ms},
                    {"new_view_ms", times.new_view_ms}});
  }
  return json;
}

}  // namespace

Provenance provenance_of(const render::GlContext& context, const TableVolumes& volumes) {
  Provenance provenance = provenance_of_this_machine();
  provenance.gl_backend = context.backend();
  provenance.gl_renderer = context.renderer_string();
  provenance.board = volumes.board;
  return provenance;
}

bool PicturesAgainst::all_explained() const {
  return std::ranges::all_of(agreements, [](const PictureAgreement& agreement) {
    return agreement.unexplained_share <= kMostUnexplained;
  });
}

void add_tables(Json& report,
                const TableResults& results,
                const TableRun& run,
                const std::string& note,
                const Document& document) {
  report["run"] = {{"text", describe_run(run)},
                   {"note", note},
                   {"divisor", run.divisor},
                   {"repeats", run.repeats},
                   {"plain_repeats", run.plain_repeats}};
  report["reference"] = row_json(results.reference);
  report["tables"] = Json::array();
  for (const MeasuredTable& table : results.tables) report["tables"].push_back(table_json(table));
  report["stages"] = stages_json(results.stages);
  const Json tables = tables_json(document);
  for (const char* name : {"arrival", "floor", "fetches", "agreement"}) {
    if (tables.contains(name)) report[name] = tables[name];
  }
}

}  // namespace wobblebench::bench
