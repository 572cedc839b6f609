#include "render/leaping/cell_bounds.h"

namespace wobblebench::render {
namespace {

enum Bindings { kSlices };

/// Layers of a group: pairs of its four slices.
constexpr int kLayers = 3;

std::vector<MacrocellBounds> to_bounds(const float* values_and_x,
                                       const float* depth_and_frame,
                                       std::size_t cells) {
  std::vector<MacrocellBounds> bounds(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    const float* v = values_and_x + 4 * i;
    bounds[i] = {v[0], v[1], {v[2], v[3]}, {}, {}};
    if (!depth_and_frame) continue;
    const float* d = depth_and_frame + 4 * i;
    bounds[i].depth = {d[0], d[1]};
    bounds[i].frame = {d[2], d[3]};
  }
  return bounds;
}

}  // namespace

CellBoundsPass::CellBoundsPass(const MacrocellGrid& grid, bool with_slopes)
    : grid_(grid), with_slopes_(with_slopes) {
  const auto add = [&](std::vector<Texture>& textures) {
    textures.emplace_back("bounds of cells",
                          TexelFormat::rgba32f,
                          Extent{grid.columns, grid.rows * kGroupsPerBatch},
                          TextureFilter::nearest);
  };
  std::vector<const Texture*> attachments;
  for (int layer = 0; layer < kLayers; ++layer) add(values_and_x_);
  for (const Texture& texture : values_and_x_) attachments.push_back(&texture);
  if (with_slopes) {
    for (int layer = 0; layer < kLayers; ++layer) add(depth_and_frame_);
    for (const Texture& texture : depth_and_frame_) attachments.push_back(&texture);
  }
  target_ = Framebuffer(attachments);
  program_ = FragmentProgram({"cell_bounds.frag.glsl"},
                             Defines()
                                 .add("BIND_SLICES", kSlices)
                                 .add("CELL", grid.cell_pixels)
                                 .add("CELL_ROWS", grid.rows)
                                 .add("SLOPES", with_slopes));
  check_gl("bounds of cells: setting up");
}

std::vector<CellBoundsPass::Layer> CellBoundsPass::measure(const Texture& slices,
                                                           const std::vector<LayerGroup>& groups) {
  const int rows = grid_.rows * static_cast<int>(groups.size());
  program_.draw_region(target_, {{kSlices, &slices}}, {0, 0, grid_.columns, rows});
  const auto cells = static_cast<std::size_t>(grid_.columns) * static_cast<std::size_t>(grid_.rows);
  std::vector<Layer> layers;
  for (int layer = 0; layer < kLayers; ++layer) {
    const auto index = static_cast<std::size_t>(layer);
    const std::vector<float> values = values_and_x_[index].download_rows(rows);
    const std::vector<float> slopes =
        with_slopes_ ? depth_and_frame_[index].download_rows(rows) : std::vector<float>();
    for (std::size_t group = 0; group < groups.size(); ++group) {
      if (layer >= groups[group].count) continue;
      const std::size_t begin = 4 * cells * group;
      layers.push_back(
          {groups[group].first + layer,
           to_bounds(
               values.data() + begin, with_slopes_ ? slopes.data() + begin : nullptr, cells)});
    }
  }
  return layers;
}

}  // namespace wobblebench::render
