// Terms that help on held-out sets are taken, and no others.
#include "bench/evaluation/error_model/term_choice.h"

#include <gtest/gtest.h>

#include <random>

#include "base/units.h"

namespace wobblebench::bench {
namespace {

constexpr int kSets = 5;
const std::vector<std::vector<int>> kFolds = {{0}, {1}, {2}, {3}, {4}};

/// Independent terms, and an error of `error_mm(x, set)` with noise of 0.3 mm.
template <class Error>
std::vector<ErrorRow> rows_of(const Error& error_mm) {
  std::mt19937 generator(5);
  std::normal_distribution<float> normal;
  std::vector<ErrorRow> rows;
  for (int i = 0; i < 5000; ++i) {
    ErrorRow row;
    row.set = i % kSets;
    row.pixel.measured = true;
    for (float& x : row.pixel.x) x = normal(generator);
    row.pixel.x[kConstantTerm] = 1;
    row.error_m = (error_mm(row.pixel.x, row.set) + 0.3f * normal(generator)) *
                  static_cast<float>(kMillimetre);
    rows.push_back(row);
  }
  return rows;
}

TEST(TermChoice, TakesWhatMakesTheErrorTheLargestFirst) {
  const auto choice = choose_terms(
      rows_of([](const auto& x, int) { return 2 * x[kLateralTerm] - 0.5f + 0.2f * x[kBumpTerm]; }),
      kFolds);
  ASSERT_EQ(choice.order.size(), 2u) << "the bump's share, 1 %, is below the least gain";
  EXPECT_EQ(choice.order[0].term, kLateralTerm);
  EXPECT_EQ(choice.order[1].term, kConstantTerm);
  EXPECT_TRUE(choice.taken[kLateralTerm] && choice.taken[kConstantTerm]);
  // 0.09 + 0.04 of 4 + 0.25 + 0.04 + 0.09 mm^2, the largest errors with less weight.
  EXPECT_NEAR(choice.order[1].left, 0.03, 0.015);
}

TEST(TermChoice, TakesNothingThatDoesNotCarryOverToAnotherSet) {
  // In each set another slope: a fit to all of them explains each of them in part, and no new one.
  const auto rows =
      rows_of([](const auto& x, int set) { return (set % 2 == 0 ? 1.0f : -1.5f) * x[kDepthTerm]; });
  EXPECT_TRUE(choose_terms(rows, kFolds).order.empty());
}

TEST(TermChoice, OfNoiseOrNothingTakesNothing) {
  EXPECT_TRUE(choose_terms(rows_of([](const auto&, int) { return 0.0f; }), kFolds).order.empty());
  EXPECT_TRUE(choose_terms({}, kFolds).order.empty());
}

}  // namespace
}  // namespace wobblebench::bench
