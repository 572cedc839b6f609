// What `tune` is asked, how it searches, and what it says of the ends of a plan, against known
// answers.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "base/user_error.h"
#include "bench/evaluation/seed_statistics.h"
#include "bench/studies/tune/tune_study.h"

namespace wobblebench::bench {
namespace {

TradeScore score(double volume_ms, double p95_mm, double half_mm = 0, double median_mm = 0) {
  TradeScore result;
  result.volume_ms = volume_ms;
  result.measures.assign(traded().size(), {0, 0, 3});
  result.measures[trade_measure("p95_mm")] = {p95_mm, half_mm, 3};
  result.measures[trade_measure("median_mm")] = {median_mm, 0, 3};
  result.scenes = {{result, 0}};
  return result;
}

/// Of two scenes, and their mean.
TradeScore score_of_two(const TradeScore& a, const TradeScore& b, double mean_p95_mm) {
  TradeScore both = score(0, mean_p95_mm);
  both.scenes = {{a, 0}, {b, 1}};
  return both;
}

TEST(TuneLimit, IsANameAndANumber) {
  const TuneLimit limit = parse_limit("p95_mm<=2.5");
  EXPECT_EQ(limit.name, "p95_mm");
  EXPECT_EQ(limit.most, 2.5);
  for (const char* wrong : {"p95_mm",
                            "p95<=2",
                            "p95_mm<=",
                            "p95_mm<=two",
                            "p95_mm<=0",
                            "p95_mm<=-1",
                            "p95_mm<=nan",
                            "p95_mm<=2 mm",
                            "<=2"}) {
    EXPECT_THROW(parse_limit(wrong), UserError) << wrong;
  }
  EXPECT_THROW(check_quantity("--least", "speed"), UserError);
  EXPECT_NO_THROW(check_quantity("--least", "view_ms"));
}

/// 1 and 3 mm are 2 on average, and 3 is beyond a limit of 2.5.
TEST(TuneRequest, ALimitIsForEverySceneAndAMeanOnlyByAsking) {
  const TradeScore both = score_of_two(score(1, 1, 0.1), score(1, 3, 0.1), 2);
  const Reached reached = quantity_of(both, "p95_mm");
  EXPECT_EQ(reached.value, 3);
  EXPECT_EQ(reached.scene, 1U);
  EXPECT_EQ(quantity_of(both, "mean:p95_mm").value, 2);
  EXPECT_EQ(quantity_of(both, "mean:p95_mm").scene, std::nullopt);
  EXPECT_GT(upper_quantity(both, "p95_mm").value, 3);
  EXPECT_NEAR(excess_of({"volume_ms", {{"p95_mm", 2.5}}}, both), 0.2, 1e-12);
  EXPECT_EQ(excess_of({"volume_ms", {parse_limit("mean:p95_mm<=2.5")}}, both), 0);
  const TradeScore none = score_of_two(score(1, std::nan("")), score(1, 1), 1);
  EXPECT_EQ(quantity_of(none, "p95_mm").scene, 0U);
  EXPECT_GT(excess_of({"volume_ms", {{"p95_mm", 2.5}}}, none), 1000);
  EXPECT_THROW(parse_limit("mean:p95<=2"), UserError);
  EXPECT_THROW(parse_limit("mean:<=2"), UserError);
}

TEST(TuneRequest, ExcessIsTheSumOfThePartsAboveEachLimit) {
  const TuneRequest request{"volume_ms", {{"p95_mm", 2}, {"volume_ms", 100}, {"median_mm", 0.1}}};
  EXPECT_EQ(excess_of(request, score(100, 2)), 0);
  EXPECT_NEAR(excess_of(request, score(150, 3)), 1.0, 1e-12);
  EXPECT_NEAR(excess_of(request, score(1, 1, 0, -0.2)), 1.0, 1e-12);  // by its magnitude
  EXPECT_GT(excess_of(request, score(1, std::nan(""))), 1000);
}

/// n = 3: a 95 % interval of +-h is 4.303 s / sqrt(3); a further value is below the mean + 2.920 s
/// sqrt(4 / 3) with 95 % (t of 2 degrees of freedom, tables).
TEST(TuneRequest, AFurtherSeedStaysBelowTheBoundOfStudent) {
  const double deviation = 0.1;
  const double half = 4.30265 * deviation / std::sqrt(3.0);
  EXPECT_NEAR(upper_quantity(score(1, 2, half), "p95_mm").value,
              2 + 2.91999 * deviation * std::sqrt(4.0 / 3),
              1e-4);
  EXPECT_EQ(upper_quantity(score(7, 2), "volume_ms").value, 7);
  EXPECT_TRUE(std::isinf(upper_of_next({2, std::nan(""), 1})));
}

/// Within the limit place 1 may lie 0.3 off 0.7: the least cost, 0, is at level 3 and place 1.
/// level 3.
SearchValue valley(const SearchPoint& at) {
  const double off = at[0] - 3, error = std::abs(at[1] - 0.7) + 0.05 * off * off;
  return {1 - at[1] + 0.1 * off * off, std::max(0.0, error / 0.3 - 1)};
}

double best_of(SearchMethod method, std::uint64_t seed, int* calls = nullptr) {
  double best = std::numeric_limits<double>::infinity();
  int count = 0;
  search({{6}, {0}, {4}, {4}, {0}}, {}, {method, 300, seed}, [&](const SearchPoint& at) {
    ++count;
    SearchValue value = valley(at);
    value.goal += 0.05 * (at[2] + at[3]) + 0.2 * at[4];  // best at 0 each
    if (value.excess == 0) best = std::min(best, value.goal);
    return value;
  });
  if (calls != nullptr) *calls = count;
  return best;
}

/// The least within the limit is 0 (at 3, 1, 0, 0, 0).
TEST(TuneSearch, FindsWhatIsBestWithinTheLimitAndBeatsChance) {
  double searched = 0, by_chance = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    int calls = 0;
    const double best = best_of(SearchMethod::nsga2, seed, &calls);
    EXPECT_LE(calls, 300);
    EXPECT_LT(best, 0.15) << seed;
    searched += best / 10;
    by_chance += best_of(SearchMethod::random, seed) / 10;
  }
  EXPECT_LT(searched, 0.5 * by_chance);
}

TEST(TuneSearch, EvaluatesNoPointTwiceAndEndsWhereAllAreKnown) {
  for (const SearchMethod method : {SearchMethod::nsga2, SearchMethod::random}) {
    std::set<SearchPoint> seen;
    search({{3}, {4}}, {{2, 3}}, {method, 1000, 1}, [&](const SearchPoint& at) {
      EXPECT_TRUE(seen.insert(at).second);
      return SearchValue{at[0] + at[1], 0};
    });
    EXPECT_LE(seen.size(), 12U);
    EXPECT_GE(seen.size(), 8U);
  }
}

TEST(TuneSearch, IsTheSameEachTimeForTheSameSeed) {
  EXPECT_EQ(best_of(SearchMethod::nsga2, 4), best_of(SearchMethod::nsga2, 4));
}

TradePlan plan_of_three() {
  TradePlan plan;
  plan.axes = {{"a.steps", {"128", "256", "512"}, {}},
               {"a.level", {}, TradeAxis::Range{0.1, 10, true}},
               {"a.mode", {"\"fast\"", "\"plain\""}, {}}};
  plan.axes[1].levels = {"1", "2", "3", "4"};  // its quarters
  return plan;
}

TEST(TuneEnds, AreNamedOfNumbersAlone) {
  const TradePlan plan = plan_of_three();
  using Keys = std::vector<std::string>;
  EXPECT_EQ(keys_at_an_end(plan, point_at(plan, {0.5, 0.5, 0.9})), Keys{});
  EXPECT_EQ(keys_at_an_end(plan, point_at(plan, {0.1, 0.5, 0.1})), Keys{"a.steps"});
  EXPECT_EQ(keys_at_an_end(plan, point_at(plan, {0.9, 0.99, 0.1})), (Keys{"a.steps", "a.level"}));
}

TEST(TunePoint, IsMadeAgainFromItsPlaces) {
  const TradePlan plan = plan_of_three();
  const TradePoint point = point_at(plan, {0.4, 0.5, 0.7});
  EXPECT_EQ(point.values, (std::vector<std::string>{"256", "1", "\"plain\""}));
  EXPECT_EQ(point_at(plan, shares_of(plan, point)), point);
}

}  // namespace
}  // namespace wobblebench::bench
