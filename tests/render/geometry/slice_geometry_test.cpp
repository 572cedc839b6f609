#include "render/geometry/slice_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wobblebench::render {
namespace {

hw::AcquisitionPlan plan(double sector_deg,
                         double fan_deg,
                         double wobble_radius_m,
                         int frames = 37) {
  hw::ProbeOptions probe;
  probe.wobble_radius_m = wobble_radius_m;
  hw::AcquisitionOptions acquisition;
  acquisition.sector_rad = sector_deg * kDegree;
  acquisition.fan_rad = fan_deg * kDegree;
  acquisition.frames_per_volume = frames;
  return {probe, acquisition};
}

TEST(SliceGeometry, PixelsAndCoordinatesAreInverse) {
  const SliceGeometry geometry(plan(77, 61, 27e-3), 100);
  for (double pixel : {0.0, 12.5, 99.0}) {
    EXPECT_NEAR(geometry.column(geometry.pixel_x_m(pixel)), pixel, 1e-11);
    EXPECT_NEAR(geometry.row(geometry.pixel_depth_m(pixel)), pixel, 1e-11);
  }
}

TEST(SliceGeometry, BoundsTheSectorTightly) {
  for (double sector_deg : {0.1, 77.0, 170.0}) {
    const SliceGeometry geometry(plan(sector_deg, 61, 27e-3), 64);
    const double half_rad = sector_deg * kDegree / 2;
    EXPECT_NEAR(geometry.x_max_m(), 0.2 * std::sin(half_rad), 1e-15);
    EXPECT_NEAR(geometry.depth_min_m(), 0.04 * std::cos(half_rad), 1e-15);
    EXPECT_NEAR(geometry.depth_max_m(), 0.2, 1e-15);
  }
}

TEST(SliceGeometry, LocatesEachSampleAtItsIndices) {
  const hw::AcquisitionPlan p = plan(77, 61, 27e-3);
  const SliceGeometry geometry(p, 64);
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    const int line = static_cast<int>(random() % 64), sample = static_cast<int>(random() % 512);
    const int frame = static_cast<int>(random() % 37);
    const double theta_rad = p.theta_rad(line) * (1 - 1e-12);  // keeps lines on the edge inside
    const double phi_rad = p.frame_phi_rad(frame) * (1 - 1e-12);
    const glm::dvec3 position =
        p.geometry().to_cartesian({p.sample_range_m(sample), theta_rad, phi_rad});
    const SlicePoint point = geometry.locate(position);
    ASSERT_TRUE(point.inside);
    EXPECT_NEAR(point.frame, frame, 1e-9);
    const auto index = geometry.polar_index(point.x_m, point.depth_m);
    ASSERT_TRUE(index.inside);
    EXPECT_NEAR(index.line, line, 1e-8);
    EXPECT_NEAR(index.sample, sample, 1e-8);
  }
}

TEST(SliceGeometry, ASingleFrameFillsItsFanAndASingleStickItsSector) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 1;
  acquisition.sticks_per_frame = 1;
  const hw::AcquisitionPlan p({}, acquisition);
  const SliceGeometry geometry(p, 64);
  for (double share : {-0.49, 0.0, 0.49}) {
    const glm::dvec3 position = p.geometry().to_cartesian(
        {0.05, share * acquisition.sector_rad, -share * acquisition.fan_rad});
    const SlicePoint point = geometry.locate(position);
    EXPECT_TRUE(point.inside);
    EXPECT_EQ(point.frame, 0);
    EXPECT_EQ(geometry.polar_index(point.x_m, point.depth_m).line, 0);
  }
}

TEST(SliceGeometry, ExcludesPositionsOutsideTheCone) {
  const hw::AcquisitionPlan p = plan(77, 61, 27e-3);
  const SliceGeometry geometry(p, 64);
  const hw::ProbeGeometry probe = p.geometry();
  const double edge_theta = 38.5 * kDegree, edge_phi = 30.5 * kDegree;
  EXPECT_TRUE(geometry.locate(probe.to_cartesian({0.16 - 1e-6, 0, 0})).inside);
  EXPECT_FALSE(geometry.locate(probe.to_cartesian({0.16 + 1e-6, 0, 0})).inside);
  EXPECT_FALSE(geometry.locate(probe.to_cartesian({-1e-6, 0, 0})).inside);
  EXPECT_TRUE(geometry.locate(probe.to_cartesian({0.1, edge_theta - 1e-6, 0})).inside);
  EXPECT_FALSE(geometry.locate(probe.to_cartesian({0.1, edge_theta + 1e-6, 0})).inside);
  EXPECT_TRUE(geometry.locate(probe.to_cartesian({0.1, 0, -edge_phi + 1e-6})).inside);
  EXPECT_FALSE(geometry.locate(probe.to_cartesian({0.1, 0, -edge_phi - 1e-6})).inside);
}

TEST(PolarTable, FlagsTheAreaOfTheSector) {
  const SliceGeometry geometry(plan(77, 61, 27e-3), 512);
  const std::vector<float> table =
      make_polar_table(geometry, {0, 0, geometry.slice_size(), geometry.slice_size()});
  double flagged = 0;
  for (std::size_t i = 2; i < table.size(); i += 3) flagged += table[i];
  const double box_m2 = 2 * geometry.x_max_m() * (geometry.depth_max_m() - geometry.depth_min_m());
  const double sector_m2 = 0.5 * 77 * kDegree * (0.2 * 0.2 - 0.04 * 0.04);
  EXPECT_NEAR(flagged / (512 * 512), sector_m2 / box_m2, 1e-3);
}

/// Bilinear fetch of a motion table as the GPU does it.
glm::dvec3 fetch(const MotionTable& t, double y_m, double z_m) {
  const double u = (y_m - t.y_min_m) / (t.y_max_m - t.y_min_m) * (t.size - 1);
  const double v = (z_m - t.z_min_m) / (t.z_max_m - t.z_min_m) * (t.size - 1);
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  glm::dvec3 sum(0);
  for (int corner = 0; corner < 4; ++corner) {
    const int column = i + (corner & 1), row = j + (corner >> 1);
    const double weight = (1 - std::abs(u - column)) * (1 - std::abs(v - row));
    const std::size_t at = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(t.size) +
                                static_cast<std::size_t>(column));
    sum += weight * glm::dvec3(t.values[at], t.values[at + 1], t.values[at + 2]);
  }
  return sum;
}

struct TableCase {
  const char* name;
  double sector_deg, fan_deg, wobble_radius_m;
  double depth_tolerance_m, frame_tolerance;
};

class MotionTableAccuracy : public ::testing::TestWithParam<TableCase> {};

TEST_P(MotionTableAccuracy, IsWithinTolerance) {
  const TableCase& c = GetParam();
  const hw::AcquisitionPlan p = plan(c.sector_deg, c.fan_deg, c.wobble_radius_m);
  const SliceGeometry geometry(p, 64);
  const MotionTable table = make_motion_table(geometry, kMotionTableSize);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> half(-0.5, 0.5), range(0.01, 0.16);
  double worst_depth_m = 0, worst_frame = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 position = p.geometry().to_cartesian(
        {range(random), half(random) * c.sector_deg * kDegree, half(random) * c.fan_deg * kDegree});
    const SlicePoint exact = geometry.locate(position);
    const glm::dvec3 fetched = fetch(table, position.y, position.z);
    ASSERT_GT(fetched.z, 0.999);
    worst_depth_m = std::max(worst_depth_m, std::abs(fetched.x - exact.depth_m));
    worst_frame = std::max(worst_frame, std::abs(fetched.y - exact.frame));
  }
  EXPECT_LT(worst_depth_m, c.depth_tolerance_m);
  EXPECT_LT(worst_frame, c.frame_tolerance);
}

// A wide fan about an axis near the face has the largest curvature: the entries near the axis
// determine the tolerance.
INSTANTIATE_TEST_SUITE_P(Fans,
                         MotionTableAccuracy,
                         ::testing::Values(TableCase{"paper", 77, 61, 27e-3, 1e-6, 1e-3},
                                           TableCase{"narrow", 0.1, 0.1, 27e-3, 1e-6, 1e-3},
                                           TableCase{"axis_at_centre", 77, 61, 40e-3, 1e-6, 1e-3},
                                           TableCase{"wide_fan", 60, 170, 30e-3, 3e-6, 1e-2}),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(MotionTable, IsNotFlaggedAtItsEdges) {
  const MotionTable table = make_motion_table(SliceGeometry(plan(77, 61, 27e-3), 64), 256);
  for (int i = 0; i < table.size; ++i) {
    for (std::size_t at :
         {i * table.size, i * table.size + table.size - 1, i, (table.size - 1) * table.size + i}) {
      EXPECT_EQ(table.values[3 * at + 2], 0);
    }
  }
}

TEST(FieldBox, HoldsTheWholeCone) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> half(-0.5, 0.5), range(0, 0.16);
  for (double wobble_radius_m : {0.0, 27e-3, 40e-3, 70e-3}) {
    const hw::AcquisitionPlan p = plan(170, 170, wobble_radius_m);
    const VolumeOfInterest box = field_box(SliceGeometry(p, 64));
    for (int i = 0; i < 5000; ++i) {
      const glm::dvec3 position = p.geometry().to_cartesian(
          {range(random), half(random) * 170 * kDegree, half(random) * 170 * kDegree});
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(std::abs(position[axis] - box.center_m[axis]), box.size_m[axis] / 2 + 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::render
