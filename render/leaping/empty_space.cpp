#include "render/leaping/empty_space.h"

#include <string>
#include <utility>

#include "render/leaping/ray_spans.h"

namespace wobblebench::render {
namespace {

enum Bindings { kSlices };

std::vector<MacrocellBounds> to_bounds(const std::vector<float>& values_and_x,
                                       const std::vector<float>& depth_and_frame) {
  std::vector<MacrocellBounds> bounds(values_and_x.size() / 4);
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    const float* v = values_and_x.data() + 4 * i;
    const float* d = depth_and_frame.data() + 4 * i;
    bounds[i] = {v[0], v[1], {v[2], v[3]}, {d[0], d[1]}, {d[2], d[3]}};
  }
  return bounds;
}

}  // namespace

EmptySpace::EmptySpace(SkippableCells cells, FragmentProgram& bounds_program)
    : cells_(std::move(cells)), bounds_program_(bounds_program) {
  const MacrocellGrid& grid = cells_.grid();
  distances_ = Texture("empty space",
                       TexelFormat::r8,
                       {grid.columns, grid.rows, grid.intervals},
                       TextureFilter::nearest);
  const Extent extent = {grid.columns, grid.rows, grid.intervals};
  const std::string what = "bounds of cells";
  values_and_x_ = Texture(what, TexelFormat::rgba32f, extent, TextureFilter::nearest);
  depth_and_frame_ = Texture(what, TexelFormat::rgba32f, extent, TextureFilter::nearest);
  outdated_.assign(static_cast<std::size_t>(grid.intervals), false);
  if (bounds_program_) return;
  bounds_program_ =
      FragmentProgram({"cell_bounds.frag.glsl"},
                      Defines().add("BIND_SLICES", kSlices).add("CELL", grid.cell_pixels));
}

void EmptySpace::update_bounds(const Texture& slices, int index, const LayerGroup& layers) {
  if (!cells_.can_leap()) return;
  std::vector<Framebuffer::Layer> targets;
  for (int layer = layers.first; layer < layers.first + layers.count; ++layer) {
    outdated_.at(static_cast<std::size_t>(layer)) = true;
    targets.push_back({&values_and_x_, layer});
    targets.push_back({&depth_and_frame_, layer});
  }
  bounds_program_.set("group", static_cast<double>(index))
      .draw(Framebuffer::of_layers(targets), {{kSlices, &slices}});
  changed_ = true;
}

void EmptySpace::set_cells(SkippableCells cells) {
  cells_ = std::move(cells);
  outdated_.assign(outdated_.size(), true);
  changed_ = true;
}

void EmptySpace::set_view(const RenderOptions& options) {
  cells_.set_view(options);
  changed_ = true;
}

void EmptySpace::set_level(double level) {
  cells_.set_level(level);
  changed_ = true;
}

void EmptySpace::set_covered(const FrameSpan& covered) {
  cells_.set_covered(covered);
  changed_ = true;
}

const Texture& EmptySpace::distances() {
  refresh();
  return distances_;
}

const Texture& EmptySpace::spans() {
  refresh();
  return spans_;
}

void EmptySpace::refresh() {
  if (!std::exchange(changed_, false)) return;
  for (int interval = 0; interval < cells_.grid().intervals; ++interval) {
    if (!outdated_[static_cast<std::size_t>(interval)]) continue;
    outdated_[static_cast<std::size_t>(interval)] = false;
    cells_.set_bounds(interval,
                      to_bounds(values_and_x_.download_layer(interval),
                                depth_and_frame_.download_layer(interval)));
  }
  const CellBits set = cells_.to_sample();
  distances_.upload(cell_distances(set, cells_.grid()));
  const int tiles = tiles_per_side(cells_.camera().image_size);
  if (spans_.extent().width != tiles) {
    spans_ = Texture("spans of rays", TexelFormat::rg32f, {tiles, tiles}, TextureFilter::nearest);
  }
  spans_.upload(ray_spans(set, cells_.grid(), cells_.geometry(), cells_.camera()));
}

}  // namespace wobblebench::render
