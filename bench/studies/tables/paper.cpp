#include "bench/studies/tables/paper.h"

#include <set>
#include <stdexcept>

namespace wobblebench::bench {

namespace {

TableRow varied(const std::string& setting, double paper_ms, int TableRow::*field, int value) {
  TableRow row{setting, paper_ms};
  row.*field = value;
  return row;
}

}  // namespace

const TableRow& reference_row() {
  static const TableRow row{"37 frames, 512^3, 3x3x3, 9x9", 54.6};
  return row;
}

const std::vector<PaperTable>& paper_tables() {
  static const std::vector<PaperTable> tables = {
      {"I",
       "frames per volume",
       {varied("27", 53.7, &TableRow::frames, 27),
        varied("31", 54.0, &TableRow::frames, 31),
        varied("35", 54.6, &TableRow::frames, 35),
        varied("37", 54.6, &TableRow::frames, 37)}},
      {"II",
       "volume size",
       {varied("512^3", 54.6, &TableRow::side, 512),
        varied("384^3", 35.0, &TableRow::side, 384),
        varied("256^3", 15.8, &TableRow::side, 256),
        varied("128^3", 13.2, &TableRow::side, 128)}},
      {"III",
       "3D filter kernel",
       {varied("none", 21.5, &TableRow::kernel_3d, 1),
        varied("3x3x3", 54.6, &TableRow::kernel_3d, 3),
        varied("5x5x5", 187, &TableRow::kernel_3d, 5)}},
      {"IV",
       "2D homogeneous filter",
       {varied("3x3", 54.3, &TableRow::kernel_2d, 3),
        varied("5x5", 54.9, &TableRow::kernel_2d, 5),
        varied("7x7", 55.5, &TableRow::kernel_2d, 7),
        varied("11x11", 56.8, &TableRow::kernel_2d, 11)}},
  };
  return tables;
}

std::vector<int> frame_counts() {
  std::set<int> counts;
  for (const PaperTable& table : paper_tables()) {
    for (const TableRow& row : table.rows) counts.insert(row.frames);
  }
  return {counts.begin(), counts.end()};
}

render::RenderOptions settings_of(const TableRow& row, render::RenderOptions base, int divisor) {
  base.scan_conversion.slice_size = row.side / divisor;
  base.ray_casting.image_size = row.side / divisor;
  base.ray_casting.steps = row.side / divisor;
  base.ray_casting.kernel_3d = row.kernel_3d;
  base.ray_casting.mode = render::RenderMode::surface;
  base.shading.depth_filter_size = row.kernel_2d;
  base.smoothing.filter_size = row.kernel_2d;
  return base;
}

std::string to_string(PipelineVariant variant) {
  switch (variant) {
    case PipelineVariant::plain:
      return "plain";
    case PipelineVariant::plain_slice:
      return "plain_slice";
    case PipelineVariant::fast:
      return "fast";
    case PipelineVariant::fast_ray:
      return "fast_ray";
  }
  throw std::logic_error("variant " + std::to_string(static_cast<int>(variant)) + ": has no name");
}

std::vector<PipelineVariant> variants_of(const PaperTable& table) {
  if (table.id != "III") return {PipelineVariant::plain, PipelineVariant::fast};
  return {PipelineVariant::plain,
          PipelineVariant::plain_slice,
          PipelineVariant::fast,
          PipelineVariant::fast_ray};
}

render::RenderOptions rendered(PipelineVariant variant, render::RenderOptions options) {
  const bool plain = variant == PipelineVariant::plain || variant == PipelineVariant::plain_slice;
  const bool ray = variant == PipelineVariant::plain || variant == PipelineVariant::fast_ray;
  options.pipeline.mode = plain ? render::PipelineMode::plain : render::PipelineMode::fast;
  options.ray_casting.kernel_space = ray ? render::KernelSpace::ray : render::KernelSpace::slice;
  return options;
}

}  // namespace wobblebench::bench
