#include "bench/studies/tables/tables_report.h"

#include <nlohmann/json.hpp>
#include <sstream>

namespace wobblebench::bench {

using Json = nlohmann::ordered_json;

namespace {

constexpr PipelineVariant kVariants[] = {PipelineVariant::plain,
                                         PipelineVariant::fast,
                                         PipelineVariant::plain_slice,
                                         PipelineVariant::fast_ray};

void put_spread(std::ostream& text, const Spread& spread) {
  text << "," << spread.median << "," << spread.min << "," << spread.max;
}

void put_head(std::ostream& text, const TableResults& results) {
  text << "table,setting,side,frames,kernel_3d,kernel_2d,paper_ms,paper_ratio";
  for (const PipelineVariant variant : kVariants) {
    const std::string name = to_string(variant);
    text << "," << name << "_ms," << name << "_min_ms," << name << "_max_ms," << name << "_ratio";
  }
  text << ",speed_up,acquisition_ms";
  for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
    for (const auto& pass : results.reference.timings.at(variant).passes) {
      text << "," << to_string(variant) << "_" << pass.name << "_ms";
    }
  }
  text << "\n";
}

void put_row(std::ostream& text, const std::string& table, const MeasuredRow& row, int divisor) {
  text << table << "," << row.row.setting << "," << row.row.side / divisor << "," << row.row.frames
       << "," << row.row.kernel_3d << "," << row.row.kernel_2d << "," << row.row.paper_ms << ","
       << row.paper_ratio;
  for (const PipelineVariant variant : kVariants) {
    const auto timing = row.timings.find(variant);
    if (timing == row.timings.end()) {
      text << ",,,,";
      continue;
    }
    put_spread(text, timing->second.frame_ms);
    text << "," << timing->second.ratio.median;
  }
  text << "," << row.speed_up() << ",";
  for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
    for (const auto& pass : row.timings.at(variant).passes) text << "," << pass.ms;
  }
  text << "\n";
}

void put_arrival(std::ostream& text,
                 const std::string& what,
                 const TableResults& results,
                 Spread Arrival::*spread,
                 const TableRun& run) {
  const TableRow& row = reference_row();
  const Spread& plain = results.arrival(PipelineVariant::plain).*spread;
  const Spread& fast = results.arrival(PipelineVariant::fast).*spread;
  text << "arrival," << what << "," << row.side / run.divisor << "," << row.frames << ","
       << row.kernel_3d << "," << row.kernel_2d << ",,";
  put_spread(text, plain);
  text << ",";
  put_spread(text, fast);
  text << ",,,,,,,,,"
       << "," << plain.median / fast.median << ",";
  if (spread == &Arrival::add_frame_ms) text << results.frame_acquisition_ms;
  for (const PipelineVariant variant : {PipelineVariant::plain, PipelineVariant::fast}) {
    text << std::string(results.reference.timings.at(variant).passes.size(), ',');
  }
  text << "\n";
}

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
  report["floor"] = floors_json(results);
}

std::string to_csv(const TableResults& results, const TableRun& run) {
  std::ostringstream text;
  put_head(text, results);
  for (const MeasuredTable& table : results.tables) {
    for (const MeasuredRow& row : table.rows) put_row(text, table.table.id, row, run.divisor);
  }
  put_arrival(text, "one frame", results, &Arrival::add_frame_ms, run);
  put_arrival(text, "new volume", results, &Arrival::new_volume_ms, run);
  put_arrival(text, "new view", results, &Arrival::new_view_ms, run);
  return text.str();
}

}  // namespace wobblebench::bench
