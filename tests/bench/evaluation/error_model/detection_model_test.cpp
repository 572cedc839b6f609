// Recovery of a known detection error; terms that help on held-out sets are taken, and no others.
#include "bench/evaluation/error_model/detection_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/units.h"

namespace wobblebench::bench {
namespace {

constexpr TakenTerms kAllTerms = {true, true, true, true, true, true, true, true, true, true, true};

/// Rows of a known bias and spread: bias 0.5 mm - 0.4 lateral + 2 mm contrast, spread
/// 0.3 mm exp(0.2 beam); every tenth of them 8 mm off, if there are outliers.
std::vector<ErrorRow> known_rows(int count, bool outliers) {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  std::vector<ErrorRow> rows;
  for (int i = 0; i < count; ++i) {
    ErrorRow row;
    row.pixel.measured = true;
    row.pixel.x = {1,
                   0.9f,
                   static_cast<float>(3 * uniform(generator)),
                   static_cast<float>(4 * uniform(generator)),
                   static_cast<float>(2 * uniform(generator)),
                   static_cast<float>(2 * uniform(generator)),
                   static_cast<float>(uniform(generator) - 0.5),
                   static_cast<float>(40 * uniform(generator) - 20),
                   static_cast<float>(2 * uniform(generator)),
                   static_cast<float>(uniform(generator)),
                   static_cast<float>(uniform(generator) - 0.5)};
    const double beam = std::hypot(static_cast<double>(row.pixel.x[kLateralTerm]),
                                   static_cast<double>(row.pixel.x[kElevationTerm]));
    const double bias_mm = 0.5 - 0.4 * static_cast<double>(row.pixel.x[kLateralTerm]) +
                           2 * static_cast<double>(row.pixel.x[kContrastTerm]);
    double error_mm = bias_mm + 0.3 * std::exp(0.2 * beam) * normal(generator);
    if (outliers && i % 10 == 0) error_mm = 8;
    row.error_m = static_cast<float>(error_mm * kMillimetre);
    row.block = i / 20;
    rows.push_back(row);
  }
  return rows;
}

TEST(DetectionModel, KnownTermsAreRecovered) {
  const auto model = fit_detection_model(known_rows(20000, false), kAllTerms);
  EXPECT_NEAR(model.bias[kConstantTerm].value, 0.5, 0.05);
  EXPECT_NEAR(model.bias[kLateralTerm].value, -0.4, 0.02);
  EXPECT_NEAR(model.bias[kContrastTerm].value, 2, 0.05);
  EXPECT_NEAR(model.bias[kFrameSpacingTerm].value, 0, 0.03);
  for (const ErrorTerm term : {kConstantTerm, kLateralTerm, kContrastTerm, kDepthTerm}) {
    const FittedTerm& fitted = model.bias[static_cast<std::size_t>(term)];
    EXPECT_LT(fitted.low, fitted.value) << term;
    EXPECT_GT(fitted.high, fitted.value) << term;
  }
  EXPECT_NEAR(std::exp(model.spread[0].value), 0.3, 0.02);
  EXPECT_NEAR(model.spread[1].value, 0.2, 0.02);
}

TEST(DetectionModel, ATermThatDoesNotVaryIsNamedAndHeld) {
  const auto model = fit_detection_model(known_rows(2000, false), kAllTerms);
  EXPECT_FALSE(model.bias[kBufferTerm].fitted) << "the buffer is the same in all rows";
  EXPECT_EQ(model.bias[kBufferTerm].value, 0);
  EXPECT_TRUE(model.bias[kConstantTerm].fitted);
}

TEST(DetectionModel, ATermThatIsNotTakenIsHeld) {
  TakenTerms taken = kAllTerms;
  taken[kContrastTerm] = false;
  const auto model = fit_detection_model(known_rows(2000, false), taken);
  EXPECT_FALSE(model.bias[kContrastTerm].fitted);
  EXPECT_EQ(model.bias[kContrastTerm].value, 0);
  EXPECT_TRUE(model.bias[kDepthTerm].fitted);
}

TEST(DetectionModel, OutliersDoNotMoveIt) {
  const auto model = fit_detection_model(known_rows(20000, true), kAllTerms);
  EXPECT_NEAR(model.bias[kLateralTerm].value, -0.4, 0.05);
  EXPECT_NEAR(model.bias[kConstantTerm].value, 0.5, 0.2);
}

TEST(DetectionModel, WithoutTermsPredictsExactlyNothing) {
  const auto rows = known_rows(10, false);
  for (const ErrorRow& row : rows) EXPECT_EQ(DetectionModel{}.bias_m(row.pixel), 0);
  EXPECT_EQ(fit_detection_model({}, kAllTerms).bias_m(rows[0].pixel), 0);
}

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
