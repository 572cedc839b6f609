// The bound of a picture's pixels against the bound of their conditions.
#include "bench/evaluation/bound/picture_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "base/units.h"
#include "phantoms/phantom.h"

namespace wobblebench::bench {
namespace {

constexpr double kTissue_db = -45;

struct Stage {
  hw::AcquisitionPlan plan{{}, {}};
  sim::SimulationOptions simulation;
  render::View view;
  Truth truth;

  explicit Stage(double tilt_rad, double yaw_rad = 0) {
    render::RenderOptions options;
    options.ray_casting.image_size = 32;
    options.view.yaw_rad = yaw_rad;
    view = render::make_view(options);
    const auto plane = phantoms::make_phantom({.name = "plane", .tilt_y_rad = tilt_rad});
    truth = trace_truth(phantoms::still_at(plane, view.box.center_m), plan, view);
  }
  PictureBound bound(const CountedPixel& counted) const {
    return picture_bound(truth, view.camera, plan, simulation, kTissue_db, counted);
  }
};

bool all(int /*column*/, int /*row*/) {
  return true;
}

TEST(PictureBound, IsThatOfEachPixelsConditions) {
  for (const double yaw_rad : {0.0, 30 * kDegree}) {
    const Stage stage(35 * kDegree, yaw_rad);
    const sim::BeamProfile profile{sim::ProbeOptics(stage.plan, stage.simulation)};
    const PictureBound bound = stage.bound(all);
    ASSERT_GT(bound.n, 100);
    double squares = 0;
    for (int row = 0; row < 32; ++row) {
      for (int column = 0; column < 32; ++column) {
        const float found_m = bound.map_m.at(column, row);
        if (std::isnan(found_m)) continue;
        squares += static_cast<double>(found_m) * static_cast<double>(found_m);
        if (row % 5 != 0 || column % 5 != 0) continue;
        const hw::Ray ray = stage.view.camera.ray(column, row);
        const glm::dvec3 normal(stage.truth.normal.at(column, row));
        const auto place = stage.plan.geometry().to_polar(
            ray.at(static_cast<double>(stage.truth.depth_m.at(column, row))));
        const auto conditions =
            conditions_at(stage.plan, profile, stage.simulation, place, normal, kTissue_db);
        const glm::dvec3 stick =
            stage.plan.geometry().stick(place.theta_rad, place.phi_rad).direction;
        const double expected_m = detection_bound_m(conditions) *
                                  std::abs(glm::dot(stick, normal)) /
                                  std::abs(glm::dot(ray.direction, normal));
        EXPECT_NEAR(static_cast<double>(found_m) / expected_m, 1, 0.06) << column << " " << row;
      }
    }
    EXPECT_NEAR(bound.rms_m, std::sqrt(squares / bound.n), 1e-9);
    EXPECT_NEAR(bound.between_sticks_m, bound.rms_m * 2 / 3, 1e-12);
  }
}

TEST(PictureBound, CountsWhatItIsTold) {
  const Stage stage(20 * kDegree);
  const PictureBound whole = stage.bound(all);
  const PictureBound left = stage.bound([](int column, int) { return column < 16; });
  EXPECT_LT(left.n, whole.n);
  EXPECT_GT(left.n, 0);
  EXPECT_TRUE(std::isnan(left.map_m.at(20, 16)));
  const PictureBound none = stage.bound([](int, int) { return false; });
  EXPECT_EQ(none.n, 0);
  EXPECT_TRUE(std::isnan(none.rms_m));
}

TEST(PictureBound, TableIsNearTheBound) {
  DetectionConditions like;
  BoundTable table(like);
  std::vector<DetectionConditions> all_conditions;
  std::vector<BoundTable::Entry> entries;
  for (const double incidence_deg : {0.0, 7.0, 33.0, 58.0}) {
    for (const double azimuth_deg : {0.0, 50.0}) {
      for (const double spacing_m : {3e-3, 0.5e-3}) {
        DetectionConditions c = like;
        c.incidence_rad = incidence_deg * kDegree;
        c.azimuth_rad = azimuth_deg * kDegree;
        c.tissue_db -= incidence_deg / 10;
        c.line_spacing_m = spacing_m;
        all_conditions.push_back(c);
        entries.push_back(table.add(c));
      }
    }
  }
  table.compute();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    EXPECT_NEAR(table.bound_m(entries[i]) / detection_bound_m(all_conditions[i]), 1, 0.06) << i;
  }
}

// Bilinear weights of four independent unit errors.
TEST(PictureBound, BetweenSticksErrorsAverage) {
  double sum = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps;
    sum += ((1 - t) * (1 - t) + t * t) / kSteps;
  }
  EXPECT_NEAR(kBetweenSticks, std::sqrt(sum * sum), 1e-5);
}

}  // namespace
}  // namespace wobblebench::bench
