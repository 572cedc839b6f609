// Widths, levels and speckle sizes against the independent tables of tests/yardstick.
#include "sim/speckle/speckle_kernels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "hw/probe/probe.h"
#include "tests/support/yardstick.h"

namespace wobblebench::sim {
namespace {

const hw::AcquisitionPlan& plan() {
  static const hw::AcquisitionPlan shared({}, {});
  return shared;
}

TEST(SpeckleKernels, TapsHaveTheCorrelationAskedFor) {
  std::vector<double> correlation;
  for (int lag = 0; lag < 20; ++lag) correlation.push_back(std::exp(-0.02 * lag * lag));
  const auto taps = taps_of_correlation(correlation);
  const int half = static_cast<int>(taps.size()) - 1;
  const auto tap = [&](int i) {
    return std::abs(i) > half ? 0 : taps[static_cast<std::size_t>(std::abs(i))];
  };
  for (int lag = 0; lag < 12; ++lag) {
    double sum = 0;
    for (int i = -half; i <= half; ++i) sum += tap(i) * tap(i + lag);
    EXPECT_NEAR(sum, correlation[static_cast<std::size_t>(lag)], 0.02) << lag;
  }
}

/// Lag at which the squared correlation of the filter's output is one half, twice.
double full_width(const std::vector<float>& taps, double step_m) {
  const int half = static_cast<int>(taps.size()) - 1;
  const auto correlation = [&](int lag) {
    double sum = 0;
    for (int i = -half; i <= half - lag; ++i) {
      sum += static_cast<double>(taps[static_cast<std::size_t>(std::abs(i))]) *
             static_cast<double>(taps[static_cast<std::size_t>(std::abs(i + lag))]);
    }
    return sum * sum;
  };
  int lag = 0;
  while (correlation(lag + 1) > 0.5) ++lag;
  const double low = correlation(lag), high = correlation(lag + 1);
  return 2 * step_m * (lag + (low - 0.5) / (low - high));
}

TEST(SpeckleKernels, DenseScansHaveSpeckleOfTheElementSum) {
  hw::AcquisitionOptions frames;
  frames.sticks_per_frame = 3;
  frames.frames_per_volume = 1024;
  const hw::AcquisitionPlan dense({}, frames);
  const SpeckleKernels kernels{ProbeOptics(dense)};
  for (const auto& row : yardstick("speckle", "standard")) {
    if (row.number("theta_deg") != 0) continue;
    const double range_m = row.number("depth_mm") * 1e-3;
    const double arm_m = plan().probe().radius_m + range_m - plan().geometry().axis_z_m();
    const auto taps = kernels.taps(range_m, kernels.angle_of(0));
    const double width_mm = full_width(taps, arm_m * dense.phi_step_rad()) * 1e3;
    EXPECT_NEAR(width_mm / row.number("elevation_mm"), 1, 0.1) << range_m;
  }
}

TEST(SpeckleKernels, NeighboursOfTheDefaultScanCorrelateAsTheElementSumSays) {
  const SpeckleKernels kernels{ProbeOptics(plan())};
  for (const auto& row : yardstick("neighbours")) {
    const double range_m = row.number("depth_mm") * 1e-3;
    const auto taps = kernels.taps(range_m, 0);
    const int half = static_cast<int>(taps.size()) - 1;
    double sum = 0;
    for (int i = -half; i < half; ++i) {
      sum += static_cast<double>(taps[static_cast<std::size_t>(std::abs(i))]) *
             static_cast<double>(taps[static_cast<std::size_t>(std::abs(i + 1))]);
    }
    EXPECT_NEAR(sum * sum, row.number("frame_correlation"), 0.05) << range_m;
  }
}

}  // namespace
}  // namespace wobblebench::sim
