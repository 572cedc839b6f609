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

Json spread_json(const Spread& spread) {
  return {{"median", spread.median}, {"min", spread.min}, {"max", spread.max}};
}

Json arrival_json(const TableResults& results) {
  Json json = {{"frame_acquisition_ms", results.frame_acquisition_ms}};
  for (const auto& [variant, arrival] : results.arrivals) {
    json[to_string(variant)] = {{"add_frame_ms", spread_json(arrival.add_frame_ms)},
                                {"times_acquisition", results.times_acquisition(variant)},
                                {"new_volume_ms", spread_json(arrival.new_volume_ms)},
                                {"new_view_ms", spread_json(arrival.new_view_ms)}};
  }
  return json;
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

Json floors_json(const TableResults& results) {
  Json json = {{"fetches_per_us", Json::object()}};
  for (const auto& [kind, rate] : results.floors.rates_per_us) {
    json["fetches_per_us"][to_string(kind)] = rate;
  }
  for (const auto& [variant, passes] : results.floors.passes) {
    for (const PassFloor& floor : passes) {
      Json fetches = Json::object();
      for (const auto& [kind, count] : floor.fetches) fetches[to_string(kind)] = count;
      json[to_string(variant)].push_back(
          {{"name", floor.pass},
           {"fetches", fetches},
           {"floor_ms", floor.floor_ms},
           {"ms", pass_ms(results.reference.timings.at(variant), floor.pass)}});
    }
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

Json agreement_json(const PicturesAgainst& against) {
  Json json = {{"other", against.other},
               {"filter_error", kFilterError},
               {"most_unexplained_share", kMostUnexplained},
               {"pictures", Json::array()}};
  for (const PictureAgreement& of : against.agreements) {
    json["pictures"].push_back({{"settings", of.settings},
                                {"pixels", of.pixels},
                                {"z_rms_mm", of.z_rms_mm},
                                {"z_p999_mm", of.z_p999_mm},
                                {"z_largest_mm", of.z_largest_mm},
                                {"found_in_one_share", of.found_in_one_share},
                                {"unexplained_share", of.unexplained_share},
                                {"light_rms", of.light_rms},
                                {"light_largest", of.light_largest}});
  }
  return json;
}

void add_tables(Json& report,
                const TableResults& results,
                const TableRun& run,
                const std::string& note) {
  report["run"] = {{"text", describe_run(run)},
                   {"note", note},
                   {"divisor", run.divisor},
                   {"repeats", run.repeats},
                   {"plain_repeats", run.plain_repeats}};
  report["reference"] = row_json(results.reference);
  report["tables"] = Json::array();
  for (const MeasuredTable& table : results.tables) report["tables"].push_back(table_json(table));
  report["arrival"] = arrival_json(results);
  report["stages"] = stages_json(results.stages);
  report["floor"] = floors_json(results);
}

}  // namespace wobblebench::bench
