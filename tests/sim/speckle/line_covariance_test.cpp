// Speckle across lines against the independent tables of tests/yardstick.
#include "sim/speckle/line_covariance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hw/probe/probe.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

constexpr double kLineStep_rad = 0.25 * kDegree;

/// Lines as far past the array's end as speckle there is wide.
hw::AcquisitionPlan dense_plan(hw::ProbePreset preset) {
  const hw::ProbePresetData& data = hw::probe_preset(preset);
  hw::AcquisitionOptions dense;
  dense.sticks_per_frame =
      1 + 2 * static_cast<int>(std::ceil((0.5 * data.sector_rad + 6 * kDegree) / kLineStep_rad));
  dense.sector_rad = (dense.sticks_per_frame - 1) * kLineStep_rad;
  dense.frames_per_volume = 1;
  return {data.probe, dense};
}

/// Full width at half maximum of the squared covariance of lines on both sides of an angle.
double width_m(const BandedMatrix& covariance,
               const hw::AcquisitionPlan& plan,
               double range_m,
               double theta_rad) {
  const double middle = (theta_rad - plan.theta_rad(0)) / plan.theta_step_rad();
  const auto squared = [&](int lag) {
    const int row = static_cast<int>(std::lround(middle + 0.5 * lag));
    return std::pow(covariance.at(row, lag), 2);
  };
  int lag = 2;
  while (squared(lag) > 0.5) {
    lag += 2;
    if (lag > covariance.band || middle + 0.5 * lag > covariance.rows - 1) return HUGE_VAL;
  }
  // Between two lags as a Gaussian falls: its logarithm with the square of the lag.
  const double before = std::log(squared(lag - 2)), after = std::log(squared(lag));
  const double share = (before - std::log(0.5)) / (before - after);
  const double half = std::sqrt(std::lerp(std::pow(lag - 2, 2), std::pow(lag, 2), share));
  return 2 * half * plan.theta_step_rad() * (plan.probe().radius_m + range_m);
}

TEST(LineCovariance, WidthsAreThoseOfTheElementSumToTheLastStick) {
  using enum hw::ProbePreset;
  const std::pair<hw::ProbePreset, const char*> presets[] = {
      {standard, "standard"}, {c5_2v, "c5_2v"}, {curvilinear_60, "curvilinear_60"}};
  for (const auto& [preset, name] : presets) {
    const hw::AcquisitionPlan plan = dense_plan(preset);
    const LineCovariance lines(ProbeOptics(plan), UniformLines::of(plan));
    for (const auto& row : yardstick("speckle", name)) {
      const double range_m = row.number("depth_mm") * 1e-3;
      const double theta_rad = row.number("theta_deg") * kDegree;
      const double width_mm = width_m(lines.at(range_m), plan, range_m, theta_rad) * 1e3;
      EXPECT_NEAR(width_mm / row.number("lateral_mm"), 1, 0.05)
          << name << " " << range_m << " m, " << row.number("theta_deg") << " degrees";
    }
  }
}

TEST(LineCovariance, NeighboursOfTheDefaultScanCorrelateAsTheElementSumSays) {
  const hw::AcquisitionPlan plan({}, {});
  const LineCovariance lines(ProbeOptics(plan), UniformLines::of(plan));
  for (const auto& row : yardstick("neighbours")) {
    const auto covariance = lines.at(row.number("depth_mm") * 1e-3);
    EXPECT_NEAR(
        std::pow(covariance.at(covariance.rows / 2, 1), 2), row.number("line_correlation"), 0.05)
        << row.text("depth_mm");
  }
}

TEST(LineCovariance, LinesBeyondTheArrayStandAlone) {
  hw::AcquisitionOptions wide;
  wide.sector_rad = 140 * kDegree;  // the array spans 77
  wide.sticks_per_frame = 201;
  const hw::AcquisitionPlan plan({}, wide);
  const auto covariance = LineCovariance(ProbeOptics(plan), UniformLines::of(plan)).at(60e-3);
  for (int row = 0; row < covariance.rows; ++row) EXPECT_EQ(covariance.at(row, 0), 1);
  for (int lag = 1; lag <= covariance.band; ++lag) EXPECT_EQ(covariance.at(200, lag), 0);
  // 1.22 mm apart, where speckle is 1.565 mm wide (speckle.csv): as a Gaussian falls.
  EXPECT_NEAR(covariance.at(100, 1), std::sqrt(std::pow(0.5, std::pow(2 * 1.22 / 1.565, 2))), 0.03);
}

TEST(LineCovariance, OneLineAndSparseLinesStandAlone) {
  for (const int count : {1, 2}) {
    hw::AcquisitionOptions sparse;
    sparse.sticks_per_frame = count;
    const hw::AcquisitionPlan plan({}, sparse);
    const auto covariance = LineCovariance(ProbeOptics(plan), UniformLines::of(plan)).at(60e-3);
    EXPECT_EQ(covariance.rows, count);
    EXPECT_EQ(covariance.band, 0);
  }
}

TEST(LineCovariance, DenseLinesAreThinnedToWhatSpeckleNeeds) {
  hw::AcquisitionOptions options;
  EXPECT_EQ(UniformLines::needed(ProbeOptics(hw::AcquisitionPlan({}, options))).count,
            options.sticks_per_frame);
  options.sticks_per_frame = 1024;
  const hw::AcquisitionPlan dense({}, options);
  const UniformLines needed = UniformLines::needed(ProbeOptics(dense));
  EXPECT_LT(needed.count, 1024);
  EXPECT_NEAR(needed.first_rad + (needed.count - 1) * needed.step_rad, dense.theta_rad(1023), 1e-9);
  // Speckle is finest, as an angle, at 160 mm: 2.27 mm of 200 mm (speckle.csv).
  EXPECT_LT(needed.step_rad, 2.27 / 200 / 3.5);
  options.sector_rad = 0.1 * kDegree;  // all lines are nearly one
  EXPECT_EQ(UniformLines::needed(ProbeOptics(hw::AcquisitionPlan({}, options))).count, 2);
}

/// Of the product of a factor with its transpose.
double entry(const BandedMatrix& factor, int row, int lag) {
  double sum = 0;
  for (int k = 0; k + lag <= factor.band && k + lag <= row; ++k) {
    sum += factor.at(row, k + lag) * factor.at(row - lag, k);
  }
  return sum;
}

BandedMatrix covariance(int rows, int band, double (*of_lag)(int lag)) {
  BandedMatrix matrix(rows, band);
  for (int row = 0; row < rows; ++row) {
    for (int lag = 0; lag <= std::min(row, band); ++lag) matrix.at(row, lag) = of_lag(lag);
  }
  return matrix;
}

TEST(BandedMatrix, FactorOfAFirstOrderProcessIsItsRecursion) {
  // x[n] = 0.5 x[n - 1] + sqrt(0.75) e[n], x[0] = e[0]: the weight of e[n - k] is
  // 0.5^k sqrt(0.75), of e[0] 0.5^n.
  const auto factor =
      cholesky_factor(covariance(12, 11, [](int lag) { return std::pow(0.5, lag); }), 0);
  for (int row = 0; row < 12; ++row) {
    for (int lag = 0; lag <= std::min(row, factor.band); ++lag) {
      const double expected = std::pow(0.5, lag) * (lag == row ? 1 : std::sqrt(0.75));
      EXPECT_NEAR(factor.at(row, lag), expected, 2e-4) << row << " " << lag;  // small ends left out
    }
  }
  EXPECT_EQ(factor.band, 8);  // 0.5^8 = 0.0039
}

TEST(BandedMatrix, FactorOfAMovingAverageHasItsCovariance) {
  // Means of three neighbours: 1, 2/3, 1/3.
  const auto factor =
      cholesky_factor(covariance(40, 2, [](int lag) { return (3 - lag) / 3.0; }), 1e-6);
  EXPECT_EQ(factor.band, 2);
  for (int row = 2; row < 40; ++row) {
    for (int lag = 0; lag <= 2; ++lag) {
      EXPECT_NEAR(entry(factor, row, lag), (3 - lag) / 3.0, 1e-5) << row << " " << lag;
    }
  }
}

TEST(BandedMatrix, DenseLinesAreFactoredWithWhiteNoise) {
  // Neighbours are all but the same: without the noise rounding decides.
  const double noise_share = 3e-3;
  const auto factor = cholesky_factor(
      covariance(200, 80, [](int lag) { return std::exp(-0.005 * lag * lag); }), noise_share);
  for (int row = 80; row < 200; ++row) {
    EXPECT_NEAR(entry(factor, row, 0), 1, 1e-12);
    for (const int lag : {1, 5, 10, 20, 40}) {
      EXPECT_NEAR(entry(factor, row, lag), std::exp(-0.005 * lag * lag) / (1 + noise_share), 5e-3)
          << row << " " << lag;
    }
  }
}

TEST(BandedMatrix, UncorrelatedLinesKeepTheirNoise) {
  const auto factor = cholesky_factor(covariance(5, 0, [](int) { return 1.0; }), 3e-3);
  EXPECT_EQ(factor.band, 0);
  for (int row = 0; row < 5; ++row) EXPECT_EQ(factor.at(row, 0), 1);
}

}  // namespace
}  // namespace wobblebench::sim
