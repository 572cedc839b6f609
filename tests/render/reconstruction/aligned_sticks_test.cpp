#include "render/reconstruction/aligned_sticks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/reconstruction/stick_edges.h"

namespace wobblebench::render {
namespace {

constexpr int kSamples = 400;
constexpr double kSpacing_m = 0.3e-3;

/// 0 before a range and 1 beyond it.
std::vector<float> step_at(double range_m) {
  std::vector<float> stick;
  for (int k = 0; k < kSamples; ++k) {
    stick.push_back(static_cast<float>(std::clamp(k + 1 - range_m / kSpacing_m, 0.0, 1.0)));
  }
  return stick;
}

/// Range at which samples of step_at(), mixed, reach one half.
double halfway_m(const std::vector<float>& stick) {
  for (std::size_t k = 1; k < stick.size(); ++k) {
    if (stick[k] < 0.5f) continue;
    const double past = (double{stick[k]} - 0.5) / (double{stick[k]} - double{stick[k - 1]});
    return (static_cast<double>(k) + 0.5 - past) * kSpacing_m;
  }
  return kNoEdge;
}

struct Four {
  explicit Four(const std::array<double, 4>& ranges_m) : edges_m(ranges_m) {
    for (const double range_m : ranges_m) sticks.push_back(step_at(range_m));
  }
  std::array<StickView, 4> views() const {
    std::array<StickView, 4> result;
    for (std::size_t j = 0; j < 4; ++j) result[j] = {sticks[j].data(), edges_m[j]};
    return result;
  }
  std::vector<float> mixed(double t, double reach_m = 5e-3) const {
    std::vector<float> stick(kSamples);
    mix_sticks(views(), t, reach_m, kSpacing_m, kSamples, stick.data());
    return stick;
  }
  std::array<double, 4> edges_m;
  std::vector<std::vector<float>> sticks;
};

/// Rise from 0.1 to 0.9, in samples.
int rise(const std::vector<float>& stick) {
  return static_cast<int>(
      std::count_if(stick.begin(), stick.end(), [](float v) { return v > 0.1f && v < 0.9f; }));
}

TEST(MixSticks, ASlopeStaysASharpEdgeOnTheStraightLine) {
  const Four sticks({57e-3, 60e-3, 63e-3, 66e-3});
  for (const double t : {0.0, 0.25, 0.5, 0.8, 1.0}) {
    const auto stick = sticks.mixed(t);
    EXPECT_NEAR(halfway_m(stick), 60e-3 + 3e-3 * t, 0.1e-3) << t;
    EXPECT_LE(rise(stick), 2) << t;
  }
}

TEST(MixSticks, WithoutEdgesIsPlainInterpolation) {
  Four sticks({57e-3, 60e-3, 63e-3, 66e-3});
  sticks.edges_m.fill(kNoEdge);
  const auto stick = sticks.mixed(0.5);
  EXPECT_GE(rise(stick), 9);  // 3 mm, between the middle ones
  const std::array<double, 4> weights = {1.0 / 48, 23.0 / 48, 23.0 / 48, 1.0 / 48};  // B-spline
  for (std::size_t k = 0; k < kSamples; ++k) {
    double expected = 0;
    for (std::size_t j = 0; j < 4; ++j) expected += weights[j] * double{sticks.sticks[j][k]};
    EXPECT_NEAR(stick[k], expected, 1e-6);
  }
}

TEST(MixSticks, DoesNotBridgeTwoSurfaces) {
  const Four sticks({60e-3, 60e-3, 90e-3, 90e-3});
  for (const double t : {0.2, 0.45, 0.55, 0.8}) {
    const auto stick = sticks.mixed(t);
    const auto at = [&](double range_m) {
      return stick[static_cast<std::size_t>(range_m / kSpacing_m)];
    };
    // Between the two the share of the nearer sticks, nowhere an edge half the way.
    EXPECT_NEAR(at(75e-3), at(65e-3), 1e-5) << t;
    EXPECT_NEAR(at(75e-3), at(85e-3), 1e-5) << t;
    EXPECT_EQ(at(75e-3) > 0.5f, t < 0.5) << t;
  }
}

TEST(MixSticks, OfEqualSticksIsThatStick) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> noise(kSamples);
  for (float& sample : noise) sample = uniform(random);
  std::array<StickView, 4> views;
  views.fill({noise.data(), 50e-3});
  std::vector<float> stick(kSamples);
  EXPECT_NEAR(mix_sticks(views, 0.3, 5e-3, kSpacing_m, kSamples, stick.data()), 50e-3, 1e-12);
  for (std::size_t k = 0; k < kSamples; ++k) EXPECT_NEAR(stick[k], noise[k], 1e-6);
}

/// Values stay within those of the sticks that are mixed, wherever their edges lie.
TEST(MixSticks, NeverLeavesTheRangeOfItsSticks) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    std::array<double, 4> edges{};
    for (double& edge_m : edges) edge_m = uniform(random) < 0.2 ? kNoEdge : 0.12 * uniform(random);
    Four sticks({40e-3, 50e-3, 60e-3, 70e-3});
    sticks.edges_m = edges;
    for (const float sample : sticks.mixed(uniform(random), 0.2 * uniform(random))) {
      EXPECT_GE(sample, -1e-6f);
      EXPECT_LE(sample, 1 + 1e-6f);
    }
  }
}

TEST(DensePlan, KeepsSectorAndFanAndEverySticksPlace) {
  const hw::AcquisitionPlan plan({}, {});
  const hw::AcquisitionPlan dense = dense_plan(plan, {3, 4});
  EXPECT_EQ(dense.acquisition().sticks_per_frame, 63 * 3 + 1);
  EXPECT_EQ(dense.acquisition().frames_per_volume, 36 * 4 + 1);
  EXPECT_NEAR(dense.theta_rad(3 * 20), plan.theta_rad(20), 1e-12);
  EXPECT_NEAR(dense.frame_phi_rad(4 * 9), plan.frame_phi_rad(9), 1e-12);
}

TEST(DensePlan, HasTheFewestSticksThatLieAsNearAsAsked) {
  const hw::AcquisitionPlan plan({}, {});
  RenderOptions options;
  EXPECT_EQ(dense_factors(plan, options).lines, 1);
  options.reconstruction.sticks = Sticks::aligned;
  options.volume_of_interest.center_m = {0, 0, 0.1};
  options.volume_of_interest.size_m = {0.1, 0.1, 0.1};  // to z = 150 mm
  const DenseFactors factors = dense_factors(plan, options);
  EXPECT_EQ(factors.lines, 4);   // 77 degrees / 63 at 150 mm: 3.2 mm
  EXPECT_EQ(factors.frames, 5);  // 61 degrees / 36 at 137 mm: 4.05 mm
}

TEST(DensePlan, HasNoMoreSticksThanAPlanMayHave) {
  hw::AcquisitionOptions scan;
  scan.sticks_per_frame = 1024;
  scan.frames_per_volume = 600;
  const hw::AcquisitionPlan plan({}, scan);
  RenderOptions options;
  options.reconstruction.sticks = Sticks::aligned;
  options.reconstruction.spacing_m = 0.1e-3;
  const DenseFactors factors = dense_factors(plan, options);
  EXPECT_EQ(factors.lines, 1);
  EXPECT_EQ(factors.frames, 1);
  EXPECT_NO_THROW(dense_plan(plan, factors));
}

}  // namespace
}  // namespace wobblebench::render
