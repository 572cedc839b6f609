#include "bench/studies/tables/tables_command.h"

#include <algorithm>

#include "base/number_text.h"
#include "bench/output/chart/chart_frame.h"

namespace wobblebench::bench {

namespace {

constexpr PictureSize kPanel{520, 390};
constexpr int kLegendRoom = 50;  // beside its names

/// What a table varies, on its axis.
struct Varied {
  std::string label;
  int TableRow::*value;
  Scale scale;  ///< of both axes
};

Varied varied_in(const Table& table) {
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

/// The median, with a bar to the farther quartile on either side.
void add_ratio(const Quartiles& ratio, Series& series) {
  constexpr double kMostShare = 0.9;  // a bar that reached 0 has no end on a logarithmic axis
  const double quartile = std::max(ratio.upper - ratio.median, ratio.median - ratio.lower);
  series.y.push_back(ratio.median);
  series.error.push_back(std::min(quartile, kMostShare * ratio.median));
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

/// With the legend to its right the panel is wider: all plots have one size.
Picture3 draw_panel(const MeasuredTable& table, const MeasuredRow& reference, bool legend) {
  const Varied varied = varied_in(table.table);
  Chart chart{"Table " + table.table.id + ": " + table.table.title,
              {varied.label, varied.scale},
              {"time / reference", varied.scale}};
  for (const MeasuredRow& row : table.rows) {
    // The chart's font has no superscript: 512 instead of 512^3.
    const std::string& setting = row.row.setting;
    chart.x.ticks.push_back({double(row.row.*varied.value), setting.substr(0, setting.find('^'))});
  }
  chart.series = series_of(table, reference);
  widen(chart.y, chart.series);
  PictureSize size = kPanel;
  double widest = 0;
  for (Series& series : chart.series) {
    widest = std::max(widest, Canvas::text_width(series.name, kTickText));
    if (!legend) series.name.clear();
  }
  if (legend) size.width += static_cast<int>(widest) + kLegendRoom;
  return draw(chart, size);
}

/// The two pictures, of one width, one above the other.
Picture3 stacked(const Picture3& top, const Picture3& bottom) {
  Picture3 all(top.width, top.height + bottom.height);
  std::copy(top.pixels.begin(), top.pixels.end(), all.pixels.begin());
  std::copy(bottom.pixels.begin(),
            bottom.pixels.end(),
            all.pixels.begin() + static_cast<std::ptrdiff_t>(top.pixels.size()));
  return all;
}

}  // namespace

Picture3 draw_tables(const TableResults& results) {
  std::vector<Picture3> panels;
  for (const MeasuredTable& table : results.tables) {
    panels.push_back(draw_panel(table, results.reference, panels.size() % 2 == 1));
  }
  return stacked(side_by_side({panels.at(0), panels.at(1)}),
                 side_by_side({panels.at(2), panels.at(3)}));
}

}  // namespace wobblebench::bench
