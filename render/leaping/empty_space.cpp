#include "render/leaping/empty_space.h"

#include <utility>

#include "render/leaping/ray_spans.h"

namespace wobblebench::render {

EmptySpace::EmptySpace(SkippableCells cells, CellBoundsPass& bounds)
    : cells_(std::move(cells)), bounds_(bounds) {
  const MacrocellGrid& grid = cells_.grid();
  distances_ = Texture("empty space",
                       TexelFormat::r8,
                       {grid.columns, grid.rows, grid.intervals},
                       TextureFilter::nearest);
}

void EmptySpace::update_bounds(const Texture& slices, const std::vector<LayerGroup>& groups) {
  if (!cells_.can_leap()) return;
  for (CellBoundsPass::Layer& layer : bounds_.measure(slices, groups)) {
    cells_.set_bounds(layer.interval, std::move(layer.bounds));
  }
  changed_ = true;
}

void EmptySpace::set_cells(SkippableCells cells) {
  cells.take_bounds(cells_);
  cells_ = std::move(cells);
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
  const CellBits set = cells_.to_sample();
  distances_.upload(cell_distances(set, cells_.grid()));
  const int tiles = tiles_per_side(cells_.camera().image_size);
  if (!spans_ || spans_.extent().width != tiles) {
    spans_ = Texture("spans of rays", TexelFormat::rg32f, {tiles, tiles}, TextureFilter::nearest);
  }
  spans_.upload(ray_spans(set, cells_.grid(), cells_.geometry(), cells_.camera()));
}

}  // namespace wobblebench::render
