// Recovery of a known detection error.
#include "bench/evaluation/error_model/detection_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/units.h"

namespace wobblebench::bench {
namespace {

constexpr TakenTerms kAll = {true, true, true, true, true, true, true, true, true, true, true};

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
  const auto model = fit_detection_model(known_rows(20000, false), kAll);
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
  const auto model = fit_detection_model(known_rows(2000, false), kAll);
  EXPECT_FALSE(model.bias[kBufferTerm].fitted) << "the buffer is the same in all rows";
  EXPECT_EQ(model.bias[kBufferTerm].value, 0);
  EXPECT_TRUE(model.bias[kConstantTerm].fitted);
}

TEST(DetectionModel, ATermThatIsNotTakenIsHeld) {
  TakenTerms taken = kAll;
  taken[kContrastTerm] = false;
  const auto model = fit_detection_model(known_rows(2000, false), taken);
  EXPECT_FALSE(model.bias[kContrastTerm].fitted);
  EXPECT_EQ(model.bias[kContrastTerm].value, 0);
  EXPECT_TRUE(model.bias[kDepthTerm].fitted);
}

TEST(DetectionModel, OutliersDoNotMoveIt) {
  const auto model = fit_detection_model(known_rows(20000, true), kAll);
  EXPECT_NEAR(model.bias[kLateralTerm].value, -0.4, 0.05);
  EXPECT_NEAR(model.bias[kConstantTerm].value, 0.5, 0.2);
}

TEST(DetectionModel, WithoutTermsPredictsExactlyNothing) {
  const auto rows = known_rows(10, false);
  for (const ErrorRow& row : rows) EXPECT_EQ(DetectionModel{}.bias_m(row.pixel), 0);
  EXPECT_EQ(fit_detection_model({}, kAll).bias_m(rows[0].pixel), 0);
}

}  // namespace
}  // namespace wobblebench::bench
