#include "render/passes/fast_scan_converter.h"

#include <algorithm>
#include <string>

#include "render/geometry/ray_sampling.h"

namespace wobblebench::render {
namespace {

enum LayerBinding { kLayerPolarTable, kLayerFrames, kLayerPixels, kLayerRows, kLayerNormaliser };

/// Pairs of neighbours among the slices of a group.
constexpr int kPairs = kGroupSlices - 1;

Region with_border(const Region& region, int border) {
  return {region.column - border,
          region.row - border,
          region.columns + 2 * border,
          region.rows + 2 * border};
}

/// A filter along one axis of an image, with zeros beyond its border.
std::vector<double> filter_axis(const std::vector<double>& pixels,
                                const Region& region,
                                const std::vector<double>& weights,
                                bool along_rows) {
  const int half = static_cast<int>(weights.size()) / 2;
  const std::ptrdiff_t stride = along_rows ? 1 : region.columns;
  std::vector<double> sums(pixels.size(), 0.0);
  for (int row = 0; row < region.rows; ++row) {
    for (int column = 0; column < region.columns; ++column) {
      const int index = along_rows ? column : row;
      const int count = along_rows ? region.columns : region.rows;
      const std::ptrdiff_t at = std::ptrdiff_t{row} * region.columns + column;
      for (int tap = -std::min(half, index); tap <= std::min(half, count - 1 - index); ++tap) {
        sums[static_cast<std::size_t>(at)] += weights[static_cast<std::size_t>(tap + half)] *
                                              pixels[static_cast<std::size_t>(at + tap * stride)];
      }
    }
  }
  return sums;
}

/// For each pixel, the inverse of the total weight of the pixels around it that hold data; 0 if
/// none does. With a single tap, -1 for pixels that hold data and stay unfiltered.
std::vector<float> normalisers(const std::vector<float>& polar_table,
                               const Region& region,
                               const std::vector<double>& weights,
                               bool single_tap) {
  std::vector<double> flags;
  for (std::size_t i = 2; i < polar_table.size(); i += 3) flags.push_back(polar_table[i]);
  const auto total = filter_axis(filter_axis(flags, region, weights, true), region, weights, false);
  std::vector<float> inverse;
  for (std::size_t i = 0; i < total.size(); ++i) {
    const bool unfiltered = single_tap && flags[i] > 0;
    inverse.push_back(unfiltered ? -1.0f : total[i] > 0 ? static_cast<float>(1 / total[i]) : 0.0f);
  }
  return inverse;
}

std::vector<LayerGroup> groups_of(const std::vector<int>& layers) {
  std::vector<LayerGroup> groups;
  for (const int layer : layers) {
    const bool next = !groups.empty() && groups.back().count < kPairs &&
                      groups.back().first + groups.back().count == layer;
    if (next) {
      ++groups.back().count;
    } else {
      groups.push_back({layer, 1});
    }
  }
  return groups;
}

/// Target of the last step: the group's four slices, then its pairs.
Framebuffer target_of(const LayerGroup& group,
                      const SlicePairs& slices,
                      const Framebuffer::Layer& filtered) {
  std::vector<Framebuffer::Layer> layers = {filtered};
  for (int i = 0; i < group.count; ++i) layers.push_back({&slices.texture(), group.first + i});
  return Framebuffer::of_layers(layers);
}

}  // namespace

Region pixels_that_rays_read(const SliceGeometry& geometry, const RenderOptions& options) {
  const int size = geometry.slice_size();
  if (!options.ray_casting.stop_at_box) return {0, 0, size, size};
  return pixels_within(geometry, options.volume_of_interest, kernel_radius_m(options));
}

SlicePairs::SlicePairs(const SliceGeometry& geometry, const RenderOptions& options)
    : region_(pixels_that_rays_read(geometry, options)) {
  const int pairs = std::max(geometry.frames() - 1, 1);
  texture_ = Texture("scan_conversion.slice_size = " + std::to_string(geometry.slice_size()) +
                         ", " + std::to_string(geometry.frames()) + " frames",
                     slice_formats(options.scan_conversion.format).pair,
                     {region_.columns, region_.rows, pairs, true},
                     TextureFilter::linear);
}

FastScanConverter::FastScanConverter(const SliceGeometry& geometry,
                                     const hw::AcquisitionPlan& plan,
                                     const RenderOptions& options)
    : frames_(geometry.frames()) {
  std::vector<double> weights = slice_weights(options);
  // Without a filter too, pixels next to the sector take the mean of their neighbours in it.
  single_tap_ = weights.size() == 1;
  if (single_tap_) weights.assign(3, 1.0 / 3);
  border_ = static_cast<int>(weights.size()) / 2;
  const Region inner = pixels_that_rays_read(geometry, options);
  const Region region = with_border(inner, border_);
  const std::vector<float> table = make_polar_table(geometry, region);
  const hw::AcquisitionOptions& scan = plan.acquisition();
  const FrameWindow window = window_of(table, scan);
  frame_groups_.emplace(window, scan.samples_per_stick, options.scan_conversion.format);
  const Extent pixels = {region.columns, region.rows};
  polar_table_ =
      Texture("scan-conversion LUT", TexelFormat::rgb32f, pixels, TextureFilter::nearest);
  polar_table_.upload(within_window(table, window));
  normaliser_ = Texture("slice normaliser", TexelFormat::r32f, pixels, TextureFilter::nearest);
  normaliser_.upload(normalisers(table, region, weights, single_tap_));
  const Extent batch = {region.columns, region.rows, kGroupsPerBatch, true};
  unfiltered_ = Texture("unfiltered slices", TexelFormat::rgba32f, batch, TextureFilter::nearest);
  rows_ =
      Texture("slices filtered along rows", TexelFormat::rgba32f, batch, TextureFilter::nearest);
  unfiltered_target_ = Framebuffer::of_all_layers({&unfiltered_});
  rows_target_ = Framebuffer::of_all_layers({&rows_});
  made_ = Texture("groups of slices",
                  slice_formats(options.scan_conversion.format).group,
                  {inner.columns, inner.rows, kGroupsPerBatch, true},
                  TextureFilter::nearest);
  make_programs(weights);
  check_gl("scan conversion: setting up");
}

void FastScanConverter::make_programs(const std::vector<double>& weights) {
  const Defines defines = Defines()
                              .add("BIND_POLAR_TABLE", kLayerPolarTable)
                              .add("BIND_FRAMES", kLayerFrames)
                              .add("BIND_PIXELS", kLayerPixels)
                              .add("BIND_ROWS", kLayerRows)
                              .add("BIND_NORMALISER", kLayerNormaliser)
                              .add("TAPS", static_cast<int>(weights.size()))
                              .add("SINGLE_TAP", single_tap_);
  const auto several = FragmentProgram::Layers::several;
  scan_convert_ = FragmentProgram({"scan_convert_layers.frag.glsl"}, defines, several);
  along_rows_ = FragmentProgram({"slice_rows.frag.glsl"}, defines, several);
  along_rows_.set("weights", weights);
  along_columns_ = FragmentProgram({"slice_columns.frag.glsl"}, defines);
  along_columns_.set("weights", weights).set("border", static_cast<double>(border_));
}

void FastScanConverter::convert(const std::vector<int>& layers,
                                const FrameStore& store,
                                const SlicePairs& slices,
                                const GroupsCallback& on_groups) {
  const std::vector<LayerGroup> groups = groups_of(layers);
  for (std::size_t first = 0; first < groups.size(); first += kGroupsPerBatch) {
    const auto begin = groups.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<LayerGroup> batch(
        begin, groups.end() - begin > kGroupsPerBatch ? begin + kGroupsPerBatch : groups.end());
    convert_batch(batch, store, slices);
    on_groups(made_, batch);
  }
  check_gl("scan conversion");
}

void FastScanConverter::convert_batch(const std::vector<LayerGroup>& batch,
                                      const FrameStore& store,
                                      const SlicePairs& slices) {
  upload(batch, store);
  const Region bordered = {0, 0, unfiltered_.extent().width, unfiltered_.extent().height};
  std::vector<LayerPair> all_groups;
  for (int group = 0; group < static_cast<int>(batch.size()); ++group) {
    all_groups.push_back({group, group});
  }
  scan_convert_.draw_layers(
      unfiltered_target_,
      {{kLayerPolarTable, &polar_table_}, {kLayerFrames, &frame_groups_->texture()}},
      bordered,
      all_groups);
  along_rows_.draw_layers(rows_target_, {{kLayerPixels, &unfiltered_}}, bordered, all_groups);
  for (int group = 0; group < static_cast<int>(batch.size()); ++group) {
    along_columns_.set("group", static_cast<double>(group))
        .draw(
            target_of(batch[static_cast<std::size_t>(group)], slices, {&made_, group}),
            {{kLayerRows, &rows_}, {kLayerPixels, &unfiltered_}, {kLayerNormaliser, &normaliser_}});
  }
}

void FastScanConverter::upload(const std::vector<LayerGroup>& batch, const FrameStore& store) {
  for (std::size_t group = 0; group < batch.size(); ++group) {
    FrameGroups::Slices slices;
    for (int slice = 0; slice <= batch[group].count; ++slice) {
      slices[static_cast<std::size_t>(slice)] =
          store.taps(std::min(batch[group].first + slice, frames_ - 1));
    }
    frame_groups_->upload(static_cast<int>(group), slices);
  }
}

}  // namespace wobblebench::render
