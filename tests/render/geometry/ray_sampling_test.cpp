#include "render/geometry/ray_sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace wobblebench::render {
namespace {

double sum(const std::vector<double>& weights) {
  return std::accumulate(weights.begin(), weights.end(), 0.0);
}

TEST(GaussianWeights, AreNormalisedSymmetricAndGaussian) {
  EXPECT_EQ(gaussian_weights(1), std::vector<double>{1.0});
  for (int size : {3, 5}) {
    const auto w = gaussian_weights(size);
    ASSERT_EQ(w.size(), static_cast<std::size_t>(size));
    EXPECT_NEAR(sum(w), 1, 1e-15);
    EXPECT_EQ(w.front(), w.back());
    const std::size_t middle = w.size() / 2;
    const double sigma = size / 4.0;
    EXPECT_NEAR(w[middle + 1] / w[middle], std::exp(-0.5 / (sigma * sigma)), 1e-15);
  }
}

TEST(BufferWeights, EqualTheKernelWithoutAWindow) {
  RayCastingOptions options;
  EXPECT_EQ(buffer_weights(options), std::vector<double>{1});  // the kernel lies in the slices
  options.kernel_space = KernelSpace::ray;
  EXPECT_EQ(buffer_weights(options), gaussian_weights(3));
  EXPECT_EQ(blend_weights(options), gaussian_weights(3));
}

TEST(BufferWeights, AreTheWindowsMeanWithoutAKernel) {
  RayCastingOptions options;
  options.kernel_3d = 1;
  options.window_2d = 5;
  for (double weight : buffer_weights(options)) EXPECT_DOUBLE_EQ(weight, 0.2);
  EXPECT_EQ(blend_weights(options), (std::vector<double>{0, 0, 1, 0, 0}));
}

TEST(BufferWeights, ConvolveKernelAndWindow) {
  RayCastingOptions options;
  options.kernel_space = KernelSpace::ray;
  options.kernel_3d = 5;
  options.window_2d = 3;
  const auto weights = buffer_weights(options), gaussian = gaussian_weights(5);
  ASSERT_EQ(weights.size(), 7u);
  EXPECT_NEAR(sum(weights), 1, 1e-15);
  EXPECT_NEAR(weights[0], gaussian[0] / 3, 1e-15);
  EXPECT_NEAR(weights[3], (gaussian[1] + gaussian[2] + gaussian[3]) / 3, 1e-15);
  EXPECT_EQ(blend_weights(options).size(), weights.size());
}

TEST(TransferFunction, IsLinearBetweenItsValuesAndConstantBeyond) {
  const RayCastingOptions options;  // grey 0, 0.2, 0.6, 1 at 0, 0.2, 0.5, 1
  const TransferFunction transfer(options, 1e-3);
  EXPECT_NEAR(transfer.grey(0.35), 0.4, 1e-15);
  EXPECT_NEAR(transfer.grey(0.75), 0.8, 1e-15);
  EXPECT_EQ(transfer.grey(1.5), 1);
  EXPECT_EQ(transfer.grey(-1), 0);
  EXPECT_NEAR(transfer.step_opacity(0.5), 0.25, 1e-15);
}

TEST(TransferFunction, OpacityPerLengthDoesNotDependOnTheStep) {
  const RayCastingOptions options;
  for (double value : {0.1, 0.3, 0.6, 1.0}) {
    const double whole = TransferFunction(options, 1e-3).step_opacity(value);
    const double part = TransferFunction(options, 0.125e-3).step_opacity(value);
    EXPECT_NEAR(1 - std::pow(1 - part, 8), whole, 1e-14);
  }
}

TEST(TransferFunction, TableInterpolatesTheFunction) {
  const RayCastingOptions options;
  const TransferFunction transfer(options, 0.156e-3);
  const auto table = transfer.table(kTransferTableSize);
  ASSERT_EQ(table.size(), 2u * kTransferTableSize);
  double worst = 0;
  for (int i = 0; i <= 100000; ++i) {
    const double at = i / 100000.0 * (kTransferTableSize - 1);
    const auto first = std::min(static_cast<std::size_t>(at), std::size_t{kTransferTableSize - 2});
    const double share = at - static_cast<double>(first);
    const double grey = std::lerp(double(table[2 * first]), double(table[2 * first + 2]), share);
    const double opacity =
        std::lerp(double(table[2 * first + 1]), double(table[2 * first + 3]), share);
    worst = std::max(worst, std::abs(grey - transfer.grey(i / 100000.0)));
    worst = std::max(worst, std::abs(opacity - transfer.step_opacity(i / 100000.0)));
  }
  EXPECT_LT(worst, 1e-4);  // at most a quarter of a table step times the change of slope at a knot
}

}  // namespace
}  // namespace wobblebench::render
