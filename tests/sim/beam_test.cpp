#include "sim/beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "sim/point_spread.h"

namespace wobblebench::sim {
namespace {

constexpr double kSpacing_m = 1e-3;
constexpr int kSamples = 160;

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan default_plan({}, {});
  return default_plan;
}

TEST(Beam, GridHoldsTheSticksAndWhatLiesBetween) {
  const BeamGrid grid(plan());
  EXPECT_GT(grid.per_line, 1);
  EXPECT_GT(grid.per_frame, 1);
  const auto geometry = plan().geometry();
  for (const auto& [frame, line] : {std::pair{0, 0}, {5, 17}, {36, 63}}) {
    const auto expected = geometry.stick(plan().theta_rad(line), plan().frame_phi_rad(frame));
    const auto found = grid.sightline(plan(), frame * grid.per_frame, line * grid.per_line);
    EXPECT_LT(glm::distance(expected.direction, found.direction), 1e-12);
    EXPECT_LT(glm::distance(expected.origin, found.origin), 1e-12);
  }
  EXPECT_EQ(grid.lines(plan()), 63 * grid.per_line + 1);
  EXPECT_EQ(grid.frames(plan()), 36 * grid.per_frame + 1);
}

TEST(Beam, ContinuousMotorTurnsBetweenTheSticksToo) {
  hw::AcquisitionOptions acquisition;
  acquisition.motor = hw::MotorMode::continuous;
  const hw::AcquisitionPlan turning({}, acquisition);
  const BeamGrid grid(turning);
  const auto geometry = turning.geometry();
  const auto phi = [&](int frame, int line) {
    return geometry.to_polar(grid.sightline(turning, frame, line).at(0.05)).phi_rad;
  };
  EXPECT_NEAR(phi(0, 30 * grid.per_line), turning.motor_angle_rad({0, 0, 30}), 1e-12);
  EXPECT_GT(phi(0, 30 * grid.per_line + 1), phi(0, 30 * grid.per_line));
  EXPECT_LT(phi(0, 30 * grid.per_line + 1), phi(0, 31 * grid.per_line));
}

TEST(Beam, ALoneStickHasNoNeighboursToAverage) {
  hw::AcquisitionOptions acquisition;
  acquisition.sticks_per_frame = 1;
  acquisition.frames_per_volume = 1;
  const hw::AcquisitionPlan lone({}, acquisition);
  const BeamGrid grid(lone);
  EXPECT_EQ(grid.lines(lone) * grid.frames(lone), 1);
  PowerField fine(1, 1, kSamples);
  fine.values.assign(fine.values.size(), 3.0f);
  EXPECT_EQ(averaged_under_beam(fine, grid, lone, kSpacing_m, 1).values, fine.values);
}

TEST(Beam, KeepsAnEvenField) {
  const BeamGrid grid(plan());
  PowerField fine(grid.frames(plan()), grid.lines(plan()), kSamples);
  fine.values.assign(fine.values.size(), 2.0f);
  for (float value : averaged_under_beam(std::move(fine), grid, plan(), kSpacing_m, 0).values) {
    ASSERT_NEAR(value, 2, 1e-5);
  }
}

TEST(Beam, SpreadsAnEdgeByItsWidth) {
  const BeamGrid grid(plan());
  PowerField fine(grid.frames(plan()), grid.lines(plan()), kSamples);
  // Tissue on one side of the 32nd stick, at every range; the stick itself belongs to it.
  const int edge = 32 * grid.per_line;
  for (int frame = 0; frame < fine.frames; ++frame) {
    for (int line = edge; line < fine.lines; ++line)
      std::fill_n(fine.stick(frame, line), kSamples, 1.0f);
  }
  PowerField seen = averaged_under_beam(std::move(fine), grid, plan(), kSpacing_m, 0);
  const int sample = 75;
  const double step_m =
      (plan().probe().radius_m + (sample + 0.5) * kSpacing_m) * plan().theta_step_rad();
  const double sigma_m = sigma_of_fwhm(lateral_fwhm_m(plan())) / std::sqrt(2.0);
  // Half a fine step of tissue lies before the edge stick's middle: a sampled normal integral.
  const auto share = [&](int line) {
    const double beyond_m = (line - 32) * step_m + 0.5 * step_m / grid.per_line;
    return 0.5 * std::erfc(-beyond_m / (sigma_m * std::sqrt(2.0)));
  };
  for (int line = 29; line <= 35; ++line) {
    EXPECT_NEAR(seen.stick(18, line)[sample], share(line), 0.03) << "line " << line;
  }
}

}  // namespace
}  // namespace wobblebench::sim
