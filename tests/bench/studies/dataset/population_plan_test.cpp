// What a plan of scenes draws, by known answers, and the plans that it refuses.
#include "bench/studies/dataset/population_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <set>

#include "base/user_error.h"
#include "tests/support/plan_file_test.h"

namespace wobblebench::bench {
namespace {

const std::string kBall = "[scene]\nphantom.name = \"sphere\"\n";
constexpr int kDraws = 20000;

class PopulationPlanFile : public testing_support::PlanFileTest<load_population_plan> {
 protected:
  /// The refusal behind the name of the file.
  void expect_refusal(const std::string& text, const std::string& part) {
    const std::string line = refusal(text);
    EXPECT_NE(line.find(part), std::string::npos) << text << "\n" << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
};

std::vector<double> draws(const Distribution& of, const std::string& key = "a.b") {
  std::vector<double> values;
  for (int i = 0; i < kDraws; ++i) {
    values.push_back(std::stod(of.at(unit_draw(1, static_cast<std::uint64_t>(i), key))));
  }
  return values;
}

struct Moments {
  double mean = 0, deviation = 0;
};
Moments moments(const std::vector<double>& values) {
  Moments of;
  for (const double value : values) of.mean += value / static_cast<double>(values.size());
  for (const double value : values) {
    of.deviation += (value - of.mean) * (value - of.mean) / static_cast<double>(values.size() - 1);
  }
  of.deviation = std::sqrt(of.deviation);
  return of;
}

/// Mean and deviation of a density on an interval, by sums over small steps.
template <class Density>
Moments moments_of(const Density& density, double low, double high) {
  constexpr int kSteps = 200000;
  double sum = 0, first = 0, second = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = low + (high - low) * (i + 0.5) / kSteps;
    sum += density(x);
    first += x * density(x);
    second += x * x * density(x);
  }
  const double mean = first / sum;
  return {mean, std::sqrt(second / sum - mean * mean)};
}

void expect_moments(const std::vector<double>& values, const Moments& wanted) {
  const Moments found = moments(values);
  // Four standard errors.
  const double error = 4 * wanted.deviation / std::sqrt(static_cast<double>(values.size()));
  EXPECT_NEAR(found.mean, wanted.mean, error);
  EXPECT_NEAR(found.deviation, wanted.deviation, error);
}

// By a program in another language: the draws of a plan are the same for ever.
TEST(Distribution, ADrawIsThisHash) {
  EXPECT_NEAR(unit_draw(1, 11, "phantom.identity"), 0.23417189884605527, 1e-15);
  EXPECT_NEAR(unit_draw(7, 123456, "phantom.hand"), 0.7034804408602631, 1e-15);
}

TEST(Distribution, UniformHasItsMoments) {
  const Distribution of = read_distribution({{"uniform", "[20, 34]"}});
  const auto values = draws(of);
  expect_moments(values, {27, 14 / std::sqrt(12.0)});
  EXPECT_GE(std::ranges::min(values), 20);
  EXPECT_LE(std::ranges::max(values), 34);
}

TEST(Distribution, NormalIsCutOffAtItsEnds) {
  struct Case {
    const char *normal, *within;
    double mean, spread, low, high;
  };
  for (const Case& one : {Case{"[0, 20]", "[-40, 40]", 0, 20, -40, 40},
                          Case{"[18, 4.0]", "[20, 30]", 18, 4, 20, 30},
                          Case{"[0, 1]", "[-4, -3]", 0, 1, -4, -3},
                          Case{"[0, 1]", "[3, 4]", 0, 1, 3, 4}}) {
    const Distribution of = read_distribution({{"normal", one.normal}, {"within", one.within}});
    const auto values = draws(of);
    const auto density = [&](double x) {
      const double z = (x - one.mean) / one.spread;
      return std::exp(-0.5 * z * z);
    };
    expect_moments(values, moments_of(density, one.low, one.high));
    EXPECT_GE(std::ranges::min(values), one.low);
    EXPECT_LE(std::ranges::max(values), one.high);
  }
}

/// Pearson's statistic against these shares.
double chi_square(const std::vector<double>& values, const std::map<double, double>& shares) {
  std::map<double, double> counts;
  for (const double value : values) ++counts[value];
  double sum = 0;
  for (const auto& [value, share] : shares) {
    const double expected = share * static_cast<double>(values.size());
    sum += (counts[value] - expected) * (counts[value] - expected) / expected;
    counts.erase(value);
  }
  EXPECT_TRUE(counts.empty());
  return sum;
}

TEST(Distribution, ChoiceHasItsWeights) {
  const Distribution of = read_distribution({{"choice", "[5, 7, 9]"}, {"weights", "[1, 2, 5]"}});
  // 13.8: exceeded once in 1000, two degrees of freedom.
  EXPECT_LT(chi_square(draws(of), {{5, 0.125}, {7, 0.25}, {9, 0.625}}), 13.8);
}

TEST(Distribution, IntegersAreEquallyLikely) {
  const Distribution of = read_distribution({{"integers", "[-3, 6]"}});
  std::map<double, double> shares;
  for (int i = -3; i <= 6; ++i) shares[i] = 0.1;
  // 27.9: exceeded once in 1000, nine degrees of freedom.
  EXPECT_LT(chi_square(draws(of), shares), 27.9);
}

TEST(Distribution, KeysAndScenesAreIndependent) {
  const Distribution of = read_distribution({{"uniform", "[-1, 1]"}});
  const auto a = draws(of, "phantom.identity"), b = draws(of, "phantom.identitz");
  double keys = 0, scenes = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    keys += a[i] * b[i] * 3 / kDraws;
    scenes += a[i] * a[(i + 1) % a.size()] * 3 / kDraws;
  }
  // The correlation of independent numbers has a deviation of 1 / sqrt(n).
  EXPECT_LT(std::abs(keys), 4 / std::sqrt(kDraws));
  EXPECT_LT(std::abs(scenes), 4 / std::sqrt(kDraws));
}

TEST(Strata, AreSpreadOverTheScenes) {
  const std::vector<int> counts = {1, 50, 25, 24};
  const auto of = spread_strata(counts);
  ASSERT_EQ(of.size(), 100U);
  std::vector<int> made(counts.size(), 0);
  for (std::size_t i = 0; i < of.size(); ++i) {
    ++made[of[i]];
    for (std::size_t j = 0; j < counts.size(); ++j) {
      EXPECT_NEAR(made[j], counts[j] / 100.0 * static_cast<double>(i + 1), 1.5);
    }
  }
  EXPECT_EQ(made, counts);
}

TEST(Strata, SharesBecomeTheNearestCounts) {
  EXPECT_EQ(counts_of_shares({0.5, 0.3, 0.2}, 10), (std::vector<int>{5, 3, 2}));
  EXPECT_EQ(counts_of_shares({1, 1, 1}, 10), (std::vector<int>{4, 3, 3}));
  EXPECT_EQ(counts_of_shares({0.9, 0.05, 0.05}, 10), (std::vector<int>{9, 1, 0}));
}

TEST_F(PopulationPlanFile, ANewKeyChangesNoOldDraw) {
  const std::string radius = "phantom.radius_mm = { uniform = [10, 30] }\n";
  const PopulationPlan old = load("scenes = 20\n" + kBall + radius);
  const PopulationPlan more =
      load("scenes = 20\n" + kBall + "phantom.point_echo_db = { uniform = [-60, -40] }\n" + radius +
           "simulation.noise_db = { uniform = [-100, -80] }\n");
  for (int i = 0; i < 20; ++i) {
    for (const char* key : {"phantom.radius_mm", "simulation.seed"}) {
      EXPECT_EQ(old.draw(i).value(key), more.draw(i).value(key));
    }
  }
}

TEST_F(PopulationPlanFile, TheOrderOfKeysAndDrawsIsNothing) {
  const std::string a = "phantom.radius_mm = { uniform = [10, 30] }\n",
                    b = "placement.position_mm = { choice = [[0, 0, 90], [0, 0, 120]] }\n";
  const PopulationPlan one = load("scenes = 9\n" + kBall + a + b);
  const PopulationPlan other = load("scenes = 9\n" + kBall + b + a);
  std::map<int, std::vector<std::string>> forwards;
  for (int i = 0; i < 9; ++i) forwards[i] = one.draw(i).settings;
  for (int i = 8; i >= 0; --i) EXPECT_EQ(other.draw(i).settings, forwards.at(i));
}

TEST_F(PopulationPlanFile, StrataOverrideTheScene) {
  const PopulationPlan plan =
      load("scenes = 40\n" + kBall +
           "phantom.radius_mm = { uniform = [10, 30] }\n"
           "[strata.small]\nshare = 0.25\nphantom.radius_mm = 5\n[strata.any]\nshare = 0.75\n");
  int small = 0;
  for (int i = 0; i < 40; ++i) {
    const DrawnScene drawn = plan.draw(i);
    const bool is_small = plan.strata[drawn.stratum].name == "small";
    small += is_small ? 1 : 0;
    const double radius_mm = plan.scene(drawn).phantom.radius_m * 1e3;
    EXPECT_EQ(is_small, radius_mm < 6) << radius_mm;
  }
  EXPECT_EQ(small, 10);
}

TEST_F(PopulationPlanFile, RefusesWhatCannotBeDrawn) {
  const std::string head = "scenes = 10\n" + kBall;
  expect_refusal("scenes = 0\n" + kBall, "plan.scenes = 0: must be within 1 and 1000000");
  expect_refusal(kBall, "scenes: must be given");
  expect_refusal("scenes = 10\nsceen = 1\n" + kBall, "sceen: unknown");
  expect_refusal(head + "phantom.radus_mm = 3\n", "did you mean radius_mm");
  expect_refusal(head + "radius_mm = 3\n", "scene.radius_mm: unknown");
  expect_refusal(head + "phantom.radius_mm = { uniform = [50, 200] }\n",
                 "must be within 1 and 100");
  expect_refusal(head + "phantom.radius_mm = { uniform = [5, 5] }\n", "LOW below HIGH");
  expect_refusal(head + "phantom.radius_mm = { normal = [20, 3] }\n", "normal needs within");
  expect_refusal(head + "phantom.radius_mm = { normal = [20, 1], within = [40, 50] }\n",
                 "less than a millionth");
  expect_refusal(head + "phantom.radius_mm = { choice = [20, 30], weights = [1] }\n",
                 "weights has 1 numbers for 2 values");
  expect_refusal(head + "phantom.radius_mm = { choice = [20, 30], weights = [1, 0] }\n",
                 "weights must be above 0");
  expect_refusal(head + "phantom.radius_mm = { uniform = [2, 3], weights = [1, 1] }\n",
                 "weights does not go with uniform");
  expect_refusal(head + "simulation.seed = { integers = [1.5, 3] }\n", "whole numbers");
  expect_refusal(head + "acquisition.volumes = 2\n", "acquisition.volumes: must be 1");
}

TEST_F(PopulationPlanFile, RefusesStrataThatContradict) {
  const std::string head = "scenes = 10\n" + kBall;
  expect_refusal(head + "[strata.a]\nshare = 0.5\n[strata.b]\nshare = 0.6\n", "add up to 1.1");
  expect_refusal(head + "[strata.a]\nshare = 1\n[strata.b]\nshare = 0\n", "must be above 0");
  expect_refusal(head + "[strata.a]\nshare = 0.99\n[strata.b]\nshare = 0.01\n",
                 "is no scene of 10");
  expect_refusal(head + "[strata.a]\nshare = 0.5\n[strata.b]\ncount = 5\n", "each a count");
  expect_refusal(head + "[strata.a]\ncount = 4\n[strata.b]\ncount = 5\n", "add up to 9");
  expect_refusal(head + "[strata.a]\ncount = 0\n", "must be a whole number, 1 to");
  expect_refusal(head + "[strata.a]\nshare = 1\nphantom.voxel_mm = 99\n", "stratum a");
}

std::set<std::string> values_of(const std::vector<DrawnScene>& scenes, const std::string& key) {
  std::set<std::string> values;
  for (const DrawnScene& scene : scenes) values.insert(scene.value(key));
  return values;
}

TEST_F(PopulationPlanFile, HalvesShareNoChildAndNoSpeckle) {
  const std::string strata = "[strata.a]\nshare = 0.4\n[strata.b]\nshare = 0.6\n";
  const PopulationPlan plan = load(
      "scenes = 50\nseed = 2\n[scene]\nphantom.identity = { integers = [1, 1000000] }\n" + strata);
  const auto train = scenes_of_half(plan, PopulationHalf::train, 100),
             judge = scenes_of_half(plan, PopulationHalf::judge, 100);
  EXPECT_EQ(train.size(), 25U);
  EXPECT_EQ(judge.size(), 25U);
  for (const char* key : {"phantom.identity", "simulation.seed"}) {
    auto all = values_of(train, key);
    const auto others = values_of(judge, key);
    all.insert(others.begin(), others.end());
    EXPECT_EQ(all.size(), 50U) << key;
  }
  const auto few = scenes_of_half(plan, PopulationHalf::judge, 3);
  ASSERT_EQ(few.size(), 6U);
  for (const DrawnScene& scene : few) {
    EXPECT_TRUE(std::ranges::any_of(
        judge, [&](const DrawnScene& other) { return other.index == scene.index; }));
  }
}

TEST_F(PopulationPlanFile, RefusesHalvesWithTheSameChild) {
  const PopulationPlan plan =
      load("scenes = 20\n[scene]\nphantom.identity = { integers = [1, 3] }\n");
  try {
    scenes_of_half(plan, PopulationHalf::judge, 5);
    FAIL() << "no refusal";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("is in both halves"), std::string::npos);
  }
}

}  // namespace
}  // namespace wobblebench::bench
