// Skippable cells from bounds of the slices; no GL.
#include "render/leaping/skippable_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

/// The part of the small scene's slices inside the cone, so that no cell lies on the border.
struct CellFixture {
  hw::AcquisitionPlan plan = testing::small_plan();
  RenderOptions options = testing::small_options();
  SliceGeometry geometry{plan, options.scan_conversion.slice_size};

  CellFixture() {
    options.ray_casting.mode = RenderMode::surface;
    options.volume_of_interest.center_m = {0, 0, 0.12};
    options.volume_of_interest.size_m = {0.05, 0.05, 0.04};
  }
  SkippableCells cells() const {
    return SkippableCells(
        plan, geometry, options, pixels_within(geometry, options.volume_of_interest, 0));
  }
};

/// For each cell ([interval][row][column]) the distance to the nearest one that must be sampled.
std::vector<std::uint8_t> distances_of(const SkippableCells& cells) {
  return cell_distances(cells.to_sample(), cells.grid());
}

int count_sampled(const std::vector<std::uint8_t>& distances) {
  return static_cast<int>(std::count(distances.begin(), distances.end(), 0));
}

std::vector<MacrocellBounds> flat(const MacrocellGrid& grid, float value) {
  return std::vector<MacrocellBounds>(static_cast<std::size_t>(grid.columns * grid.rows),
                                      MacrocellBounds{value, value, {}, {}});
}

/// Index of a cell in distances_of().
std::size_t at(const MacrocellGrid& l, int interval, int row, int column) {
  return static_cast<std::size_t>((interval * l.rows + row) * l.columns + column);
}

TEST(SkippableCells, ConstantSlicesAreSkippedEntirely) {
  const CellFixture fixture;
  SkippableCells cells = fixture.cells();
  ASSERT_TRUE(cells.can_leap());
  for (int k = 0; k < 20; ++k) cells.set_bounds(k, flat(cells.grid(), 1));
  const auto distances = distances_of(cells);
  EXPECT_EQ(count_sampled(distances), 0);
  EXPECT_EQ(*std::min_element(distances.begin(), distances.end()), kMaxCellDistance);
}

TEST(SkippableCells, DistancesAreChebyshevDistances) {
  const CellFixture fixture;
  SkippableCells cells = fixture.cells();
  const MacrocellGrid& l = cells.grid();
  std::mt19937 random(3);
  for (int k = 0; k < 20; ++k) {
    auto bounds = flat(l, 0.5f);
    bounds[random() % bounds.size()].depth.rise = 0.9f;
    cells.set_bounds(k, bounds);
  }
  const auto distances = distances_of(cells);
  ASSERT_GT(count_sampled(distances), 20);
  for (int trial = 0; trial < 300; ++trial) {
    const int k = int(random() % unsigned(l.intervals)), j = int(random() % unsigned(l.rows)),
              i = int(random() % unsigned(l.columns));
    int nearest = kMaxCellDistance;
    for (int z = 0; z < l.intervals; ++z) {
      for (int y = 0; y < l.rows; ++y) {
        for (int x = 0; x < l.columns; ++x) {
          if (distances[at(l, z, y, x)] != 0) continue;
          nearest =
              std::min(nearest, std::max({std::abs(z - k), std::abs(y - j), std::abs(x - i)}));
        }
      }
    }
    EXPECT_EQ(distances[at(l, k, j, i)], nearest);
  }
}

TEST(SkippableCells, AnEdgeIsSampledDownstreamWithinTheBuffer) {
  const CellFixture fixture;
  SkippableCells cells = fixture.cells();
  const MacrocellGrid& l = cells.grid();
  const int interval = 9, row = l.rows / 2,
            column = l.columns / 2;  // rays point slightly towards interval 0
  for (int k = 0; k < 20; ++k) cells.set_bounds(k, flat(l, 0.5f));
  auto bounds = flat(l, 0.5f);
  bounds[static_cast<std::size_t>(row * l.columns + column)].depth.rise = 0.9f;
  cells.set_bounds(interval, bounds);
  const auto distances = distances_of(cells);
  EXPECT_EQ(distances[at(l, interval, row, column)], 0);
  EXPECT_EQ(distances[at(l, interval, row + 1, column)], 0);  // downstream: rays run along depth
  EXPECT_NE(distances[at(l, interval, row - 1, column)], 0);  // upstream of the edge
  EXPECT_NE(distances[at(l, interval, row, column + 1)], 0);  // rays do not run along x
  EXPECT_NE(distances[at(l, interval + 3, row, column)], 0);
}

TEST(SkippableCells, AnEdgeOfTheOtherSignIsSkipped) {
  CellFixture fixture;
  for (EdgeSign edge : {EdgeSign::rising, EdgeSign::falling}) {
    fixture.options.ray_casting.edge = edge;
    SkippableCells cells = fixture.cells();
    auto bounds = flat(cells.grid(), 0.5f);
    for (MacrocellBounds& b : bounds) b.depth.fall = 0.9f;
    for (int k = 0; k < 20; ++k) cells.set_bounds(k, bounds);
    EXPECT_EQ(count_sampled(distances_of(cells)) > 0, edge == EdgeSign::falling);
  }
}

TEST(SkippableCells, SlopesBelowTheThresholdAreSkippedAndAboveItSampled) {
  const CellFixture fixture;
  SkippableCells cells = fixture.cells();
  const RayCastingOptions& o = fixture.options.ray_casting;
  // Difference of a ramp, Eq. (1): (n / 2)^2 step slope.
  const double pixel_m = fixture.geometry.pixel_depth_m(1) - fixture.geometry.pixel_depth_m(0);
  const double step = fixture.options.volume_of_interest.size_m[2] / o.steps;
  const double detectable_rise =
      o.threshold / (0.25 * o.buffer_length * o.buffer_length * step) * pixel_m;
  for (const double share : {0.9, 1.05}) {
    auto bounds = flat(cells.grid(), 0.5f);
    for (MacrocellBounds& b : bounds) b.depth.rise = static_cast<float>(share * detectable_rise);
    for (int k = 0; k < 20; ++k) cells.set_bounds(k, bounds);
    EXPECT_EQ(count_sampled(distances_of(cells)) > 0, share > 1) << share;
  }
}

// Difference, Eq. (1), is at most n / 2 times the largest sample, however steep the samples are.
TEST(SkippableCells, SamplesTooDarkForTheThresholdAreSkipped) {
  const CellFixture fixture;
  SkippableCells cells = fixture.cells();
  const RayCastingOptions& o = fixture.options.ray_casting;
  for (const double share : {0.9, 1.05}) {
    const auto brightest = static_cast<float>(share * o.threshold / (0.5 * o.buffer_length));
    auto bounds = flat(cells.grid(), brightest);
    for (MacrocellBounds& b : bounds) b.depth.rise = 0.9f;
    for (int k = 0; k < 20; ++k) cells.set_bounds(k, bounds);
    EXPECT_EQ(count_sampled(distances_of(cells)) > 0, share > 1) << share;
  }
}

// A mean that rises so far above another has a sample that does.
TEST(SkippableCells, FloorSamplesWhereAValueReachesTheRise) {
  CellFixture fixture;
  fixture.options.ray_casting.detector = Detector::floor;
  SkippableCells cells = fixture.cells();
  ASSERT_TRUE(cells.can_leap());
  cells.set_level(0.4);
  for (const float value : {0.39f, 0.41f}) {
    for (int k = 0; k < 20; ++k) cells.set_bounds(k, flat(cells.grid(), value));
    EXPECT_EQ(count_sampled(distances_of(cells)) > 0, value > 0.4f) << value;
  }
}

TEST(SkippableCells, VisibleCellsAreSampled) {
  CellFixture fixture;
  fixture.options.ray_casting.mode = RenderMode::volume;  // opaque from 0.2 on
  SkippableCells cells = fixture.cells();
  for (int k = 0; k < 20; ++k) cells.set_bounds(k, flat(cells.grid(), 0.19f));
  EXPECT_EQ(count_sampled(distances_of(cells)), 0);
  cells.set_bounds(5, flat(cells.grid(), 0.21f));
  EXPECT_EQ(count_sampled(distances_of(cells)), cells.grid().columns * cells.grid().rows);
}

/// Whether a ray of some pixel leaves the cone of valid data and comes back, by samples 0.2 mm
/// apart.
bool some_ray_returns(const SliceGeometry& geometry, const Camera& camera) {
  for (int pixel = 0; pixel < camera.image_size * camera.image_size; pixel += 7) {
    const hw::Ray ray = camera.ray(pixel % camera.image_size, pixel / camera.image_size);
    int entries = 0;
    bool inside = false;
    for (double t_m = 0; t_m < 0.8; t_m += 2e-4) {
      const bool now = geometry.locate(ray.at(t_m)).inside;
      entries += now && !inside;
      inside = now;
    }
    if (entries > 1) return true;
  }
  return false;
}

// A ray that could come back into the cone has to notice that it left it.
TEST(SkippableCells, TheConesBorderIsSampledWhereARayMayComeBackIntoTheCone) {
  CellFixture fixture;
  fixture.options.volume_of_interest.size_m = {0.3, 0.3, 0.3};
  int views_without = 0, views_that_return = 0;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle_rad(-kPi, kPi), small_rad(-0.3, 0.3);
  for (int trial = 0; trial < 40; ++trial) {
    ViewOptions& view = fixture.options.view;
    const bool tilted = trial % 2 == 0;
    view.yaw_rad = (tilted ? small_rad(random) : angle_rad(random)) + (trial % 4 == 2 ? kPi : 0);
    view.pitch_rad = tilted ? small_rad(random) : angle_rad(random);
    view.projection = trial % 3 == 0 ? Projection::perspective : Projection::parallel;
    view.eye_distance_m = 0.5;
    SkippableCells cells = fixture.cells();
    for (int k = 0; k < 20; ++k) cells.set_bounds(k, flat(cells.grid(), 0.5f));
    const int sampled = count_sampled(distances_of(cells));
    EXPECT_LT(sampled, int(distances_of(cells).size()) / 2);
    views_without += sampled == 0;
    if (some_ray_returns(fixture.geometry, make_camera(fixture.options))) {
      ++views_that_return;
      EXPECT_GT(sampled, 0) << "yaw " << view.yaw_rad << " pitch " << view.pitch_rad;
    }
  }
  EXPECT_GT(views_without, 5);
  EXPECT_GT(views_that_return, 5);
}

TEST(SkippableCells, EverythingIsSampledWithASingleFrame) {
  CellFixture fixture;
  hw::AcquisitionOptions single = fixture.plan.acquisition();
  single.frames_per_volume = 1;
  fixture.plan = hw::AcquisitionPlan(hw::ProbeOptions{}, single);
  fixture.geometry = SliceGeometry(fixture.plan, 128);
  EXPECT_FALSE(fixture.cells().can_leap());
  const auto distances = distances_of(fixture.cells());
  EXPECT_EQ(count_sampled(distances), int(distances.size()));
}

}  // namespace
}  // namespace wobblebench::render
