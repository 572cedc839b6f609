// What fit's pictures of residuals show.
#include "bench/studies/fit/fit_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

const float kNone = std::nanf("");

/// Errors of 0.01, 0.02, … 1 times `most_mm` in turn too near and too far; the model removes
/// nothing.
ResidualPicture picture(double most_mm) {
  ResidualPicture made{"made_up", Image<float>(101, 1, kNone), {}, {}};
  for (int i = 1; i <= 100; ++i) {
    const double error_mm = (i % 2 == 0 ? 0.01 : -0.01) * i * most_mm;
    made.error_m.at(i, 0) = static_cast<float>(error_mm * 1e-3);
  }
  made.bias_m = Image<float>(101, 1, kNone);
  made.left_m = made.bias_m;
  return made;
}

TEST(FitPictures, ColoursEndJustAboveNearlyAllErrors) {
  EXPECT_NEAR(residuals_limit_mm(picture(1)), 1, 1e-9);       // 98th percentile: 0.98 mm
  EXPECT_NEAR(residuals_limit_mm(picture(0.13)), 0.2, 1e-9);  // 0.127 mm
  EXPECT_TRUE(holds(residuals_caption(picture(0.13)), "±0.2 mm"));
}

TEST(FitPictures, WithoutASurfaceTheySaySo) {
  ResidualPicture empty = picture(1);
  empty.error_m = empty.bias_m;
  EXPECT_EQ(residuals_limit_mm(empty), 1);
  EXPECT_TRUE(holds(residuals_caption(empty), "no error to show"));
}

TEST(FitCharts, FoundAndCorrectedDifferInMarkStrokeAndColour) {
  ModelStudy study;
  study.bins = {{"range_mm", 50, 7, 0.5, 0.5}, {"range_mm", 60, 8, 0.4, 0.4}};
  const auto figures = fit_figures(study);
  ASSERT_EQ(figures.size(), 1u);
  ASSERT_EQ(figures[0].panels.size(), 1u);
  const auto& series = std::get<Chart>(figures[0].panels[0]).series;
  ASSERT_EQ(series.size(), 2u);
  EXPECT_NE(series[0].mark, series[1].mark);
  EXPECT_NE(series[0].stroke, series[1].stroke);
  EXPECT_NE(series[0].colour, series[1].colour);
  EXPECT_EQ(series[1].y, (std::vector<double>{0.5, 0.4}));
}

/// A degree, a millimetre or a percent of each parameter, which has radians, metres and a share.
TEST(FitDocument, ParametersAreInTheUnitsOfTheirRows) {
  FitResults results{};
  Registration& fit = results.known_pose;
  for (std::size_t i = 0; i < fit.value.size(); ++i) {
    const std::string& name = registration_names()[i];
    const double one = name.ends_with("_rad") ? kPi / 180 : name.ends_with("_m") ? 1e-3 : 0.01;
    fit.value[i] = one;
    fit.low[i] = 0.5 * one;
    fit.high[i] = 1.5 * one;
  }
  const std::string page = markdown(fit_document(results, {}));
  for (const char* row : {"rotation x, deg",
                          "rotation y, deg",
                          "rotation z, deg",
                          "translation x, mm",
                          "translation y, mm",
                          "translation z, mm",
                          "speed of sound, true over assumed less 1, %",
                          "bias along the ray, mm",
                          "motor angle offset, deg",
                          "wobble radius, mm"}) {
    EXPECT_NE(page.find(std::string(row) + " | 1.000 (0.500 to 1.500) |"), std::string::npos)
        << row << page;
  }
}

}  // namespace
}  // namespace wobblebench::bench
