// Made-up results, for tests of the writers.
#pragma once

#include <cmath>

#include "bench/studies/tables/measure.h"

namespace wobblebench::bench::testing {

/// Time of a row: plain grows with the volume and the kernel's square, fast little.
inline double made_up_ms(const TableRow& row, PipelineVariant variant) {
  const double side = row.side / 512.0, kernel = row.kernel_3d * row.kernel_3d;
  switch (variant) {
    case PipelineVariant::plain:
      return 200 * row.frames / 37.0 + 620 * kernel * std::pow(side, 3);
    case PipelineVariant::plain_slice:
      return 200 * row.frames / 37.0 + 540 * kernel * std::pow(side, 3);
    case PipelineVariant::fast:
      return 1.1 * row.frames + row.kernel_2d + 100 * std::pow(side, 2);
    default:
      return 1.1 * row.frames + row.kernel_2d + 130 * kernel * std::pow(side, 2);
  }
}

inline Timing made_up_timing(const TableRow& row, PipelineVariant variant) {
  const double ms = made_up_ms(row, variant);
  const double ratio = ms / made_up_ms(reference_row(), variant);
  return {{ms, 0.98 * ms, 1.03 * ms},
          {{"scan_conversion", 0.2 * ms},
           {"ray_casting", 0.7 * ms},
           {"surface_shading", 0.06 * ms},
           {"smoothing", 0.04 * ms}},
          {0.97 * ratio, ratio, 1.01 * ratio}};
}

inline MeasuredRow made_up_row(const TableRow& row, const std::vector<PipelineVariant>& variants) {
  MeasuredRow measured{row, row.paper_ms / reference_row().paper_ms, {}};
  for (const PipelineVariant variant : variants)
    measured.timings[variant] = made_up_timing(row, variant);
  return measured;
}

inline TableResults made_up_results() {
  TableResults results;
  for (const PaperTable& table : paper_tables()) {
    MeasuredTable measured{table, {}, {}};
    for (const TableRow& row : table.rows) {
      measured.rows.push_back(made_up_row(row, variants_of(table)));
    }
    if (table.id == "II") measured.exponents = Exponents{1.05, 2.8, 1.4};
    results.tables.push_back(measured);
  }
  results.reference = made_up_row(reference_row(), {PipelineVariant::plain, PipelineVariant::fast});
  results.arrivals[PipelineVariant::plain] = {
      {6.1, 5.9, 7}, {5755, 5691, 6168}, {5520, 5500, 5540}};
  results.arrivals[PipelineVariant::fast] = {{1.25, 1.1, 1.9}, {149, 146, 152}, {103, 101, 104}};
  results.frame_acquisition_ms = 13.3;
  const render::TextureFetch slices = {render::TextureFetch::Sampler::layers,
                                       render::TexelFormat::rg16,
                                       render::TextureFilter::linear};
  results.floors.rates_per_us = {{slices, 300}};
  results.floors.passes[PipelineVariant::plain] = {{"ray_casting", {{slices, 900'000'000}}, 3000}};
  results.floors.passes[PipelineVariant::fast] = {{"ray_casting", {{slices, 9'000'000}}, 30}};
  return results;
}

}  // namespace wobblebench::bench::testing
