// Plans of the command `trade`, and the points that they make.
#include "bench/studies/trade/trade_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "base/user_error.h"
#include "tests/support/expect.h"
#include "tests/support/plan_file_test.h"

namespace wobblebench::bench {
namespace {

const std::string kBall = "[scenes.ball]\nphantom.name = \"sphere\"\n";
const std::string kAxes =
    "[axes]\n\"render.ray_casting.steps\" = [64, 128, 256]\n"
    "\"render.ray_casting.detector\" = [\"paper\", \"iso\"]\n";
const std::string kRange =
    "\"render.ray_casting.iso_level\" = { from = 0.5, to = 0.9 }\n"
    "\"render.reconstruction.spacing_mm\" = { from = 0.5, to = 8, logarithmic = true }\n";

using TradePlanFile = testing_support::PlanFileTest<load_trade_plan>;

std::map<std::string, int> counts(const std::vector<TradePoint>& points, std::size_t axis) {
  std::map<std::string, int> result;
  for (const TradePoint& point : points) ++result[point.values[axis]];
  return result;
}

TEST_F(TradePlanFile, NamesScenesReferenceSeedsAndAxes) {
  const TradePlan plan = load(
      "seeds = 2\nfirst_seed = 7\nrepeats = 5\n[reference.render]\n"
      "preset = \"baseline\"\n" +
      kBall + kAxes);
  EXPECT_EQ(plan.seeds, (std::vector<std::uint64_t>{7, 8}));
  EXPECT_EQ(plan.repeats, 5);
  ASSERT_EQ(plan.reference.settings.size(), 1U);
  EXPECT_EQ(plan.scenes.at(0).name, "ball");
  ASSERT_EQ(plan.axes.size(), 2U);
  const auto points = design_points(plan);
  const Scene scene = load_scene({}, settings_of(plan, points.at(0)));
  EXPECT_EQ(scene.render.ray_casting.steps, 64);
}

TEST_F(TradePlanFile, APopulationGivesOneHalfToMeasureOnAndTheOtherToJudgeOn) {
  std::ofstream(folder_ / "population.toml")
      << "scenes = 20\n[scene]\nphantom.name = \"sphere\"\n"
         "phantom.radius_mm = { uniform = [20, 30] }\n"
         "[strata.a]\nshare = 0.5\n[strata.b]\nshare = 0.5\n";
  const std::string drawn = "population = \"population.toml\"\nper_stratum = 2\n";
  const TradePlan plan = load(drawn + kAxes);
  ASSERT_EQ(plan.scenes.size(), 4U);
  ASSERT_EQ(plan.unseen.size(), 4U);
  EXPECT_EQ(std::ranges::count(plan.strata, "a"), 2);
  EXPECT_EQ(std::ranges::count(plan.unseen_strata, "b"), 2);
  std::set<std::string> names;
  for (const auto* half : {&plan.scenes, &plan.unseen}) {
    for (const NamedOptions& scene : *half) {
      names.insert(scene.name);
      for (const std::string& setting : scene.settings) {
        EXPECT_FALSE(setting.starts_with("simulation.seed")) << setting;
      }
    }
  }
  EXPECT_EQ(names.size(), 8U);
  const TradePlan other = load(drawn + "half = \"judge\"\n" + kAxes);
  EXPECT_EQ(other.scenes.at(0).name, plan.unseen.at(0).name);
  EXPECT_TRUE(holds(refusal(drawn + kBall + kAxes), "scenes: is drawn by the population"));
  EXPECT_TRUE(holds(refusal("per_stratum = 2\n" + kBall + kAxes), "acts with population alone"));
}

TEST_F(TradePlanFile, AGridHasEveryCombinationOnce) {
  const auto points = design_points(load(kBall + kAxes));
  std::set<std::vector<std::string>> different;
  for (const TradePoint& point : points) different.insert(point.values);
  EXPECT_EQ(points.size(), 6U);
  EXPECT_EQ(different.size(), 6U);
}

/// McKay, Beckman and Conover 1979: one point in each of N strata of each axis.
TEST_F(TradePlanFile, ALatinHypercubeHasAPointInEachStratum) {
  const int n = 60;
  const TradePlan plan =
      load("design = \"latin_hypercube\"\npoints = 60\n" + kBall + kAxes + kRange);
  const auto points = design_points(plan);
  ASSERT_EQ(points.size(), std::size_t{n});
  for (std::size_t axis = 0; axis < plan.axes.size(); ++axis) {
    if (!plan.axes[axis].range) {
      for (const auto& [value, count] : counts(points, axis)) {
        EXPECT_EQ(count, n / static_cast<int>(plan.axes[axis].levels.size())) << value;
      }
      continue;
    }
    const auto& range = *plan.axes[axis].range;
    std::set<int> strata;
    for (const TradePoint& point : points) {
      const double value = std::stod(point.values[axis]);
      const double share = range.logarithmic
                               ? std::log(value / range.from) / std::log(range.to / range.from)
                               : (value - range.from) / (range.to - range.from);
      strata.insert(static_cast<int>(share * n));
      EXPECT_EQ(point.levels[axis], static_cast<int>(share * 4));
    }
    EXPECT_EQ(strata.size(), std::size_t{n});
  }
}

/// The first 2^k points of a Sobol sequence are even in each axis, whatever it is shifted by but
/// for one point at each end of a level.
TEST_F(TradePlanFile, ASobolSequenceIsEvenInEachAxis) {
  const TradePlan plan = load("design = \"sobol\"\npoints = 128\n" + kBall + kAxes + kRange);
  const auto points = design_points(plan);
  for (std::size_t axis = 0; axis < plan.axes.size(); ++axis) {
    std::map<int, int> levels;
    for (const TradePoint& point : points) ++levels[point.levels[axis]];
    const double even = 128.0 / static_cast<double>(plan.axes[axis].levels.size());
    for (const auto& [level, count] : levels) EXPECT_NEAR(count, even, 2) << axis << " " << level;
  }
}

/// Degrees, millimetres and decibels: what a scene keeps in radians and metres.
TEST_F(TradePlanFile, ValuesOfARangeAreInTheUnitOfItsKey) {
  const TradePlan plan = load("design = \"latin_hypercube\"\npoints = 16\n" + kBall +
                              "[axes]\n\"render.view.yaw_deg\" = { from = -40, to = 80 }\n"
                              "\"acquisition.depth_mm\" = { from = 120, to = 200 }\n"
                              "\"simulation.noise_db\" = { from = -60, to = -20 }\n");
  ASSERT_EQ(plan.axes.at(2).key, "simulation.noise_db");
  EXPECT_EQ(plan.axes[1].levels.at(0), "-40 to -10");
  std::map<std::string, std::vector<double>> values;
  for (const TradePoint& point : design_points(plan)) {
    const Scene scene = load_scene({}, settings_of(plan, point));
    values["120 200"].push_back(scene.acquisition.depth_m / 1e-3);
    values["-40 80"].push_back(scene.render.view.yaw_rad * 180 / kPi);
    values["-60 -20"].push_back(scene.simulation.noise_db);
    EXPECT_NEAR(std::stod(point.values[1]), values["-40 80"].back(), 1e-9);
  }
  for (const auto& [ends, drawn] : values) {
    double from = 0, to = 0;
    std::istringstream(ends) >> from >> to;
    const auto [least, most] = std::ranges::minmax(drawn);
    EXPECT_NEAR(least, from, (to - from) / 16) << ends;
    EXPECT_NEAR(most, to, (to - from) / 16) << ends;
  }
}

TEST_F(TradePlanFile, PointsAreTheSameEachTimeAndOthersForAnotherSeed) {
  for (const std::string design : {"latin_hypercube", "sobol"}) {
    const std::string text = "design = \"" + design + "\"\npoints = 20\n";
    const auto points = design_points(load(text + kBall + kAxes + kRange));
    EXPECT_EQ(points, design_points(load(text + kBall + kAxes + kRange)));
    EXPECT_NE(points, design_points(load(text + "design_seed = 2\n" + kBall + kAxes + kRange)));
  }
}

TEST_F(TradePlanFile, IsRefusedWithKeyAndWhatIsAllowed) {
  const std::string sampled = "design = \"sobol\"\npoints = 8\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {kAxes, "scenes: must be one or more tables"},
      {kBall, "axes: must be a table"},
      {kBall + "[axes]\n", "axes: must be a table"},
      {"seeds = 0\n" + kBall + kAxes, "plan.seeds = 0: must be within 1 and 1000"},
      {"point = 5\n" + kBall + kAxes, "point: unknown; keys of a plan are"},
      {"points = 5\n" + kBall + kAxes, "points: follows from the axes of a grid"},
      {"design = \"sobol\"\n" + kBall + kAxes, "points: must be given"},
      {"design = \"best\"\n" + kBall + kAxes, "plan.design = 'best': must be one of"},
      {kBall + kAxes + kRange, "must be a list of values for a grid"},
      {kBall + "[axes]\nsteps = [1, 2]\n", "axes.steps: must be a quoted"},
      {kBall + "[axes]\n\"simulation.seed\" = [1, 2]\n", "is set by seeds; leave it out"},
      {kBall + "[axes]\n\"a.b\" = [1]\n", "axes.\"a.b\": must have 2 to 64 values"},
      {kBall + "[axes]\n\"a.b\" = [1, 1]\n", "axes.\"a.b\": has a value twice"},
      {kBall + "[axes]\n\"a.b\" = 1\n", "axes.\"a.b\": must be a list of values"},
      {sampled + kBall + "[axes]\n\"a.b\" = { from = 2, to = 1 }\n", "from must be less than to"},
      {sampled + kBall + "[axes]\n\"a.b\" = { from = \"x\", to = 1 }\n", "from must be a number"},
      {sampled + kBall + "[axes]\n\"a.b\" = { from = 0, to = 1, logarithmic = true }\n",
       "from of a logarithmic range must be above 0"},
      {sampled + kBall + "[axes]\n\"a.b\" = { from = 0, to = 1, step = 2 }\n", "step: unknown"}};
  for (const auto& [text, words] : cases) {
    const std::string line = refusal(text);
    EXPECT_TRUE(holds(line, words)) << text << "\n";
    EXPECT_FALSE(holds(line, "\n"));
  }
}

}  // namespace
}  // namespace wobblebench::bench
