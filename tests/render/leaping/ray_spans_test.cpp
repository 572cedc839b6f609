// Spans of rays against cells that SliceGeometry::locate() finds along them; no GL.
#include "render/leaping/ray_spans.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

struct Fixture {
  explicit Fixture(bool skewed) {
    hw::AcquisitionOptions acquisition = testing::small_plan().acquisition();
    if (skewed) acquisition.motor = hw::MotorMode::continuous;
    plan = hw::AcquisitionPlan(testing::small_plan().probe(), acquisition);
    options.ray_casting.image_size = 44;  // not a multiple of a tile
    geometry = SliceGeometry(plan, options.scan_conversion.slice_size);
    grid = make_macrocell_grid(geometry, pixels_within(geometry, options.volume_of_interest, 0));
  }

  hw::AcquisitionPlan plan = testing::small_plan();
  RenderOptions options = testing::small_options();
  SliceGeometry geometry{plan, options.scan_conversion.slice_size};
  MacrocellGrid grid;
};

/// Whether the position lies in a cell of the set, for a sweep in this direction.
bool in_set(const Fixture& f, const CellBits& set, const glm::dvec3& position_m, int sweep) {
  const SlicePoint point = f.geometry.locate(position_m, sweep);
  const auto cell = [&](double pixel, int first) {
    return static_cast<int>(std::floor((pixel + 0.5 - first) / f.grid.cell_pixels));
  };
  const int column = cell(f.geometry.column(point.x_m), f.grid.pixels.column);
  const int row = cell(f.geometry.row(point.depth_m), f.grid.pixels.row);
  const int interval = static_cast<int>(std::floor(point.frame));
  if (column < 0 || column >= f.grid.columns || row < 0 || row >= f.grid.rows || interval < 0 ||
      interval >= f.grid.intervals) {
    return false;
  }
  return set[static_cast<std::size_t>(interval * f.grid.rows + row)] >> column & 1;
}

CellBits random_set(const MacrocellGrid& grid, int cells, std::mt19937& random) {
  CellBits set(static_cast<std::size_t>(grid.intervals * grid.rows), 0);
  for (int i = 0; i < cells; ++i) {
    set[random() % set.size()] |= std::uint64_t{1} << (random() % unsigned(grid.columns));
  }
  return set;
}

ViewOptions random_view(std::mt19937& random) {
  std::uniform_real_distribution<double> angle_rad(-kPi, kPi), eye_m(0.1, 0.6);
  ViewOptions view;
  view.yaw_rad = angle_rad(random);
  view.pitch_rad = angle_rad(random);
  view.roll_rad = angle_rad(random);
  view.flip = random() % 2 == 0;
  view.projection = random() % 2 == 0 ? Projection::perspective : Projection::parallel;
  view.eye_distance_m = eye_m(random);
  return view;
}

/// Span of the tile of a pixel.
Span span_of(const std::vector<float>& spans, int image_size, int column, int row) {
  const int tile = row / kTilePixels * tiles_per_side(image_size) + column / kTilePixels;
  const auto i = 2 * static_cast<std::size_t>(tile);
  return {spans[i], spans[i + 1]};
}

class RaySpans : public ::testing::TestWithParam<bool> {};

// Every position of a ray in a cell of the set lies in the span of the ray's tile, from whatever
// side it is seen; and where no ray of a tile meets a cell, few tiles have a span.
TEST_P(RaySpans, HoldAllThatRaysMeet) {
  Fixture f(GetParam());
  ASSERT_EQ(f.geometry.is_skewed(), GetParam());
  std::mt19937 random(11);
  int met = 0, tiles_with_span = 0, tiles_met = 0;
  for (int trial = 0; trial < 12; ++trial) {
    f.options.view = random_view(random);
    const Camera camera = make_camera(f.options);
    const CellBits set = random_set(f.grid, 3, random);
    const auto spans = ray_spans(set, f.grid, f.geometry, camera);
    const int side = tiles_per_side(camera.image_size);
    ASSERT_EQ(spans.size(), 2u * unsigned(side * side));
    std::vector<bool> is_met(static_cast<std::size_t>(side * side), false);
    for (int row = 0; row < camera.image_size; ++row) {
      for (int column = 0; column < camera.image_size; ++column) {
        const hw::Ray ray = camera.ray(column, row);
        const Span span = span_of(spans, camera.image_size, column, row);
        for (double t_m = 0; t_m < 0.7; t_m += 2e-3) {
          const int sweep = GetParam() && trial % 2 ? -1 : 1;
          if (!in_set(f, set, ray.at(t_m), sweep)) continue;
          ++met;
          is_met[static_cast<std::size_t>(row / kTilePixels * side + column / kTilePixels)] = true;
          ASSERT_GE(t_m, span.from_m - 1e-6) << trial << " " << column << " " << row;
          ASSERT_LE(t_m, span.to_m + 1e-6) << trial << " " << column << " " << row;
        }
      }
    }
    for (std::size_t i = 0; i < is_met.size(); ++i) {
      tiles_met += is_met[i];
      tiles_with_span += spans[2 * i + 1] >= spans[2 * i];
    }
  }
  EXPECT_GT(met, 50);
  EXPECT_LE(tiles_with_span, 4 * tiles_met);
}

TEST_P(RaySpans, AreEmptyWithoutCells) {
  const Fixture f(GetParam());
  const CellBits none(static_cast<std::size_t>(f.grid.intervals * f.grid.rows), 0);
  const auto spans = ray_spans(none, f.grid, f.geometry, make_camera(f.options));
  for (std::size_t i = 0; i < spans.size(); i += 2) EXPECT_LT(spans[i + 1], spans[i]);
}

INSTANTIATE_TEST_SUITE_P(Motors, RaySpans, ::testing::Bool(), [](const auto& motor) {
  return std::string(motor.param ? "continuous" : "stepped");
});

}  // namespace
}  // namespace wobblebench::render
