#include <sstream>

#include "bench/studies/tables/tables_report.h"

namespace wobblebench::bench {

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

}  // namespace

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
