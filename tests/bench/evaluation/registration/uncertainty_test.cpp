// Intervals of the mean of a process whose correlation is known.
#include "bench/evaluation/registration/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wobblebench::bench {
namespace {

constexpr double kNoHuber = 1e9;

/// x[i] = rho x[i - 1] + noise, of unit variance.
std::vector<double> autoregressive(int count, double rho, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x = {normal(generator)};
  while (static_cast<int>(x.size()) < count) {
    x.push_back(rho * x.back() + std::sqrt(1 - rho * rho) * normal(generator));
  }
  return x;
}

double mean_of(const std::vector<double>& x) {
  double sum = 0;
  for (const double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

/// Of the mean as the one parameter, in blocks of so many neighbours.
BootstrapResult bootstrap_of_mean(const std::vector<double>& x, int block) {
  const double mean = mean_of(x);
  BlockAccumulator sums(1, kNoHuber);
  for (std::size_t i = 0; i < x.size(); ++i) {
    sums.add(static_cast<std::int64_t>(i) / block, mean - x[i], Eigen::VectorXd::Ones(1));
  }
  return bootstrap_blocks(sums.blocks(), Eigen::VectorXd::Zero(1), 1, 400);
}

TEST(BlockBootstrap, DeviationOfACorrelatedMeanIsTheKnownOne) {
  constexpr double kRho = 0.9;
  constexpr int kCount = 40000;
  const auto x = autoregressive(kCount, kRho, 5);
  // Variance of the mean of an AR(1) process: (1 + rho) / (1 - rho) / n.
  const double known = std::sqrt((1 + kRho) / (1 - kRho) / kCount);
  const double by_blocks = std::sqrt(bootstrap_of_mean(x, 200).covariance(0, 0));
  const double by_points = std::sqrt(bootstrap_of_mean(x, 1).covariance(0, 0));
  EXPECT_NEAR(by_blocks, known, 0.15 * known);
  EXPECT_NEAR(by_points, 1 / std::sqrt(kCount), 0.15 / std::sqrt(kCount));
}

TEST(BlockBootstrap, IntervalsCoverTheMeanOfACorrelatedProcess) {
  int covered = 0, covered_by_points = 0;
  constexpr int kTrials = 200;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto x = autoregressive(6000, 0.8, 100 + static_cast<unsigned>(trial));
    const auto covers = [&](const BootstrapResult& result) {
      return mean_of(x) + result.low[0] <= 0 && mean_of(x) + result.high[0] >= 0;
    };
    covered += covers(bootstrap_of_mean(x, 100));
    covered_by_points += covers(bootstrap_of_mean(x, 1));
  }
  EXPECT_GE(covered, kTrials * 90 / 100);
  EXPECT_LE(covered_by_points, kTrials * 70 / 100);
}

TEST(BlockBootstrap, WhatTheDataDoNotShowKeepsItsPrior) {
  BlockAccumulator sums(2, kNoHuber);
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 1000; ++i) sums.add(i, normal(generator), Eigen::Vector2d(1, 0));
  Eigen::Vector2d precision(0, 1 / 9.0);
  const BootstrapResult result = bootstrap_blocks(sums.blocks(), precision);
  EXPECT_NEAR(std::sqrt(result.covariance(1, 1)), 3, 0.3);
  EXPECT_NEAR(result.high[1], 1.96 * 3, 0.9);
  precision[1] = 0;
  EXPECT_EQ(bootstrap_blocks(sums.blocks(), precision).covariance(1, 1), 0);
}

TEST(BlockBootstrap, IsTheSameEachTime) {
  const auto x = autoregressive(500, 0.5, 1);
  EXPECT_EQ(bootstrap_of_mean(x, 10).low[0], bootstrap_of_mean(x, 10).low[0]);
}

}  // namespace
}  // namespace wobblebench::bench
