// Against the tables of Abramowitz and Stegun, and moments of a cut Gaussian in closed form.
#include "sim/optics/gauss_rule.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"

namespace wobblebench::sim {
namespace {

TEST(GaussRule, OnTheWholeAxisItIsGaussHermite) {
  // Table 25.10, n = 4 and n = 8; weights over sqrt(pi).
  const GaussRule four(-7, 7, 4);
  ASSERT_EQ(four.nodes().size(), 4u);
  EXPECT_NEAR(four.nodes()[0], -1.650680123885785, 1e-9);
  EXPECT_NEAR(four.nodes()[2], 0.524647623275290, 1e-9);
  EXPECT_NEAR(four.weights()[0], 0.08131283544725 / std::sqrt(kPi), 1e-9);
  EXPECT_NEAR(four.weights()[2], 0.8049140900055 / std::sqrt(kPi), 1e-9);
  const GaussRule eight(-7, 7, 8);
  ASSERT_EQ(eight.nodes().size(), 8u);
  EXPECT_NEAR(eight.nodes()[7], 2.930637420257244, 1e-8);
  EXPECT_NEAR(eight.weights()[7], 1.996040722114e-4 / std::sqrt(kPi), 1e-9);
}

TEST(GaussRule, IntegratesOverACutGaussian) {
  // The mean of x over exp(-x^2) from `low` on: exp(-low^2) / (sqrt(pi) erfc(low)); the mean
  // square is 1/2 + low times the mean, by parts.
  const double low = -1.3;
  const GaussRule rule(low, 7, 8);
  double sum = 0, mean = 0, square = 0;
  for (std::size_t i = 0; i < rule.nodes().size(); ++i) {
    EXPECT_GT(rule.nodes()[i], low);
    sum += rule.weights()[i];
    mean += rule.weights()[i] * rule.nodes()[i];
    square += rule.weights()[i] * rule.nodes()[i] * rule.nodes()[i];
  }
  const double expected = std::exp(-low * low) / (std::sqrt(kPi) * std::erfc(low));
  EXPECT_NEAR(sum, 1, 1e-9);
  EXPECT_NEAR(mean, expected, 1e-5);
  EXPECT_NEAR(square, 0.5 + low * expected, 1e-5);
}

TEST(GaussRule, LagrangePolynomialsInterpolate) {
  const GaussRule rule(-2, 7, 8);
  for (int node = 0; node < 8; ++node) {
    for (int at = 0; at < 8; ++at) {
      EXPECT_NEAR(rule.lagrange(node, rule.nodes()[static_cast<std::size_t>(at)]),
                  node == at ? 1 : 0,
                  1e-8);
    }
  }
  double cube = 0;
  for (int node = 0; node < 8; ++node) {
    cube += std::pow(rule.nodes()[static_cast<std::size_t>(node)], 3) * rule.lagrange(node, 0.7);
  }
  EXPECT_NEAR(cube, 0.7 * 0.7 * 0.7, 1e-8);
}

}  // namespace
}  // namespace wobblebench::sim
