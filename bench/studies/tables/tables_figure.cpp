#include "bench/studies/tables/tables_command.h"

#include <algorithm>

#include "base/number_text.h"

namespace wobblebench::bench {

namespace {

/// What a table varies, on its axis.
struct Varied {
  std::string label;
  int TableRow::*value;
  Scale scale;  ///< of both axes
};

Varied varied_in(const PaperTable& table) {
  if (table.id == "I") return {"frames per volume", &TableRow::frames, Scale::linear};
  if (table.id == "II") return {"side of the volume (voxels)", &TableRow::side, Scale::logarithmic};
  if (table.id == "III") return {"3D kernel (taps)", &TableRow::kernel_3d, Scale::logarithmic};
  return {"2D filter (pixels)", &TableRow::kernel_2d, Scale::linear};
}

/// Rows by rising value.
std::vector<MeasuredRow> in_order(const MeasuredTable& table, int TableRow::*value) {
  auto rows = table.rows;
  std::sort(rows.begin(), rows.end(), [&](const MeasuredRow& a, const MeasuredRow& b) {
    return a.row.*value < b.row.*value;
  });
  return rows;
}

/// At least 0.5 to 1.5, so that small changes look small.
void widen(Axis& axis, const std::vector<Series>& series) {
  double low = 1, high = 1;
  for (const Series& s : series) {
    low = std::min(low, *std::min_element(s.y.begin(), s.y.end()));
    high = std::max(high, *std::max_element(s.y.begin(), s.y.end()));
  }
  if (low > 0.5 && high < 1.5) {
    axis.low = 0.5;
    axis.high = 1.5;
  } else if (axis.scale == Scale::linear) {
    axis.low = 0.0;
  }
}

/// Legend with the time of the reference row.
std::string reference_text(const std::string& name, double ms) {
  return name + ", 1 = " + fixed(ms, ms < 1 ? 2 : ms < 100 ? 1 : 0) + " ms";
}

/// The median and its quartiles.
void add_ratio(const Quartiles& ratio, Series& series) {
  series.y.push_back(ratio.median);
  series.low.push_back(ratio.lower);
  series.high.push_back(ratio.upper);
}

std::vector<Series> series_of(const MeasuredTable& table, const MeasuredRow& reference) {
  const auto value = varied_in(table.table).value;
  const std::string paper_text = reference_text("paper", reference.row.paper_ms);
  Series paper{paper_text, {}, {}, Stroke::dashed, Mark::diamond, 6};
  Series plain{reference_text("plain", reference.ms(PipelineVariant::plain)), {}, {}};
  plain.mark = Mark::square;
  plain.colour = 0;
  Series fast{reference_text("fast", reference.ms(PipelineVariant::fast)), {}, {}};
  fast.mark = Mark::disc;
  fast.colour = 2;
  for (const MeasuredRow& row : in_order(table, value)) {
    for (Series* series : {&paper, &plain, &fast}) series->x.push_back(row.row.*value);
    paper.y.push_back(row.paper_ratio);
    add_ratio(row.timings.at(PipelineVariant::plain).ratio, plain);
    add_ratio(row.timings.at(PipelineVariant::fast).ratio, fast);
  }
  return {paper, plain, fast};
}

Chart table_chart(const MeasuredTable& table, const MeasuredRow& reference) {
  const Varied varied = varied_in(table.table);
  Chart chart{"Table " + table.table.id + ": " + table.table.title,
              {varied.label, varied.scale},
              {"time / reference", varied.scale}};
  for (const MeasuredRow& row : table.rows) chart.x.ticks.push_back(row.row.*varied.value);
  chart.series = series_of(table, reference);
  widen(chart.y, chart.series);
  return chart;
}

}  // namespace

Figure tables_chart(const TableResults& results) {
  Figure figure{"ratios", "Times of each table as multiples of the reference row's.", {}};
  for (const MeasuredTable& table : results.tables) {
    figure.panels.emplace_back(table_chart(table, results.reference));
  }
  return figure;
}

}  // namespace wobblebench::bench
