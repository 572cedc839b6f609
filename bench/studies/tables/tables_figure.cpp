#include "bench/studies/tables/tables_report.h"

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

/// The median ratio, its quartiles, and the time that it is of.
void add_point(double x, const Timing& timing, Series& series) {
  constexpr int kDigits = 3;
  series.add(x, timing.ratio.median);
  series.low.push_back(timing.ratio.lower);
  series.high.push_back(timing.ratio.upper);
  series.notes.push_back(significant(timing.frame_ms.median, kDigits) + " ms");
}

/// Axis as the setting was run: sides are the paper's over the divisor.
double as_run(const TableRow& row, int TableRow::*value, const TableRun& run) {
  return value == &TableRow::side ? static_cast<double>(row.side) / run.divisor : row.*value;
}

std::vector<Series> series_of(const MeasuredTable& table,
                              const MeasuredRow& reference,
                              const TableRun& run) {
  const auto value = varied_in(table.table).value;
  Series paper{.name = reference_text("paper", reference.row.paper_ms),
               .stroke = Stroke::dashed,
               .mark = Mark::diamond,
               .colour = 6};
  Series plain{.name = reference_text("plain", reference.ms(PipelineVariant::plain)),
               .mark = Mark::square,
               .colour = 0};
  Series fast{.name = reference_text("fast", reference.ms(PipelineVariant::fast)),
              .mark = Mark::disc,
              .colour = 2};
  for (const MeasuredRow& row : in_order(table, value)) {
    const double x = as_run(row.row, value, run);
    paper.add(x, row.paper_ratio);
    paper.notes.push_back(fixed(row.row.paper_ms, 1) + " ms");
    add_point(x, row.timings.at(PipelineVariant::plain), plain);
    add_point(x, row.timings.at(PipelineVariant::fast), fast);
  }
  return {paper, plain, fast};
}

Chart table_chart(const MeasuredTable& table, const MeasuredRow& reference, const TableRun& run) {
  const Varied varied = varied_in(table.table);
  Chart chart{.title = "Table " + table.table.id + ": " + table.table.title,
              .x = {.label = varied.label, .scale = varied.scale},
              .y = {.label = "time / reference", .scale = varied.scale}};
  for (const MeasuredRow& row : table.rows) {
    chart.x.ticks.push_back(as_run(row.row, varied.value, run));
  }
  chart.series = series_of(table, reference, run);
  widen(chart.y, chart.series);
  return chart;
}

}  // namespace

std::vector<Figure> tables_figures(const TableResults& results, const TableRun& run) {
  std::vector<Figure> figures = {
      {"frames_size", "Times over frames and size, as multiples of the reference row's.", {}},
      {"kernels", "Times over both kernels, as multiples of the reference row's.", {}}};
  for (const MeasuredTable& table : results.tables) {
    const bool of_kernel = table.table.id == "III" || table.table.id == "IV";
    figures[of_kernel ? 1 : 0].panels.emplace_back(table_chart(table, results.reference, run));
  }
  return figures;
}

}  // namespace wobblebench::bench
