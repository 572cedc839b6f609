#include "bench/studies/tables/tables_rows.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace wobblebench::bench {

namespace {

constexpr PipelineVariant kVariants[] = {PipelineVariant::plain,
                                         PipelineVariant::fast,
                                         PipelineVariant::plain_slice,
                                         PipelineVariant::fast_ray};
constexpr PipelineVariant kCompared[] = {PipelineVariant::plain, PipelineVariant::fast};

/// A row by the keys of its columns; what is absent is an empty cell.
using Cells = std::map<std::string, Cell>;

Column ms_column(const std::string& key, const std::string& title) {
  return {key, title, "ms", 3, true};
}

/// Quartiles where there are several ratios.
Cell ratio_cell(const Quartiles& ratio) {
  if (ratio.lower == ratio.upper) return ratio.median;
  return Cell::spread(ratio.median, ratio.lower, ratio.upper);
}

std::string pass_key(PipelineVariant variant, const std::string& pass) {
  return to_string(variant) + "_" + pass + "_ms";
}

std::vector<Column> columns_of(const MeasuredRow& reference) {
  std::vector<Column> columns = {{"table"},
                                 {"setting"},
                                 {"side", "side as run"},
                                 {"frames"},
                                 {"kernel_3d"},
                                 {"kernel_2d"},
                                 ms_column("paper_ms", "paper"),
                                 {"paper_ratio", "paper ratio"}};
  for (const PipelineVariant variant : kVariants) {
    const std::string name = to_string(variant);
    columns.push_back(ms_column(name + "_ms", name));
    columns.push_back({name + "_ratio", name + " ratio"});
  }
  columns.push_back({"speed_up", "plain / fast", "", 3, true});
  columns.push_back(ms_column("acquisition_ms", "acquisition"));
  for (const PipelineVariant variant : kCompared) {
    const std::string name = to_string(variant);
    columns.push_back(
        {name + "_times_acquisition", name + ", times faster than acquired", "", 3, true});
  }
  for (const PipelineVariant variant : kCompared) {
    for (const PassTiming& pass : reference.timings.at(variant).passes) {
      columns.push_back(
          ms_column(pass_key(variant, pass.name), pass.name + ", " + to_string(variant)));
    }
  }
  for (const PassTiming& pass : reference.timings.at(PipelineVariant::fast).passes) {
    columns.push_back({pass.name + "_speed_up", pass.name + ", plain / fast", "", 3, true});
  }
  return columns;
}

Cells setting_cells(const std::string& table,
                    const std::string& setting,
                    const TableRow& row,
                    const TableRun& run) {
  return {{"table", table},
          {"setting", setting},
          {"side", row.side / run.divisor},
          {"frames", row.frames},
          {"kernel_3d", row.kernel_3d},
          {"kernel_2d", row.kernel_2d}};
}

Cells measured_cells(const std::string& table, const MeasuredRow& measured, const TableRun& run) {
  Cells cells = setting_cells(table, measured.row.setting, measured.row, run);
  cells["paper_ms"] = measured.row.paper_ms;
  cells["paper_ratio"] = measured.paper_ratio;
  cells["speed_up"] = measured.speed_up();
  for (const auto& [variant, timing] : measured.timings) {
    cells[to_string(variant) + "_ms"] = timing.frame_ms;
    cells[to_string(variant) + "_ratio"] = ratio_cell(timing.ratio);
    for (const PassTiming& pass : timing.passes) cells[pass_key(variant, pass.name)] = pass.ms;
  }
  for (const PassTiming& pass : measured.timings.at(PipelineVariant::fast).passes) {
    const auto times = measured.pass_speed_up(pass.name);
    if (times) cells[pass.name + "_speed_up"] = *times;
  }
  return cells;
}

Cells arrival_cells(const std::string& what,
                    const TableResults& results,
                    Spread Arrival::*spread,
                    const TableRun& run) {
  Cells cells = setting_cells("arrival", what, reference_row(), run);
  for (const PipelineVariant variant : kCompared) {
    cells[to_string(variant) + "_ms"] = results.arrival(variant).*spread;
  }
  cells["speed_up"] = (results.arrival(PipelineVariant::plain).*spread).median /
                      (results.arrival(PipelineVariant::fast).*spread).median;
  if (spread != &Arrival::add_frame_ms) return cells;
  cells["acquisition_ms"] = results.frame_acquisition_ms;
  for (const PipelineVariant variant : kCompared) {
    cells[to_string(variant) + "_times_acquisition"] = results.times_acquisition(variant);
  }
  return cells;
}

void add(Table& table, const Cells& cells) {
  std::vector<Cell> row;
  for (const Column& column : table.columns) {
    const auto found = cells.find(column.key);
    row.push_back(found == cells.end() ? Cell() : found->second);
  }
  table.add(std::move(row));
}

}  // namespace

Table all_rows(const TableResults& results, const TableRun& run) {
  Table table{.name = "rows", .columns = columns_of(results.reference)};
  for (const MeasuredTable& measured : results.tables) {
    for (const MeasuredRow& row : measured.rows) {
      add(table, measured_cells(measured.table.id, row, run));
    }
  }
  add(table, arrival_cells("one frame", results, &Arrival::add_frame_ms, run));
  add(table, arrival_cells("new volume", results, &Arrival::new_volume_ms, run));
  add(table, arrival_cells("new view", results, &Arrival::new_view_ms, run));
  return table;
}

Table part_of(const Table& rows, const std::string& id, const std::vector<std::string>& keys) {
  Table part{.name = rows.name, .columns = rows.columns};
  std::copy_if(rows.rows.begin(),
               rows.rows.end(),
               std::back_inserter(part.rows),
               [&](const std::vector<Cell>& row) { return row.front().text() == id; });
  return with_columns(part, keys);
}

}  // namespace wobblebench::bench
