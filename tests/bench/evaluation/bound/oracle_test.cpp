// The oracle reaches the bound: on drawn samples, and on sticks of the simulator.
#include "tests/bench/evaluation/bound/oracle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"
#include "tests/bench/evaluation/bound/bound_samples.h"
#include "tests/bench/evaluation/bound/plane_oracle.h"

namespace wobblebench::bench {
namespace {

struct DrawnResult {
  double ratio = 0;  ///< of the oracle's RMS to the bound
  double bias = 0;   ///< in bounds
};

DrawnResult oracle_on_drawn(const EdgeSignal& signal, double first_m, int samples) {
  constexpr double kOracleEdge_m = 0.03e-3;
  constexpr int kDraws = 1500;
  const auto at = edge_covariance(signal, kOracleEdge_m, first_m, samples);
  const double bound_m = 1 / std::sqrt(covariance_information(at.value, at.derivative));
  const SearchGrid search{kOracleEdge_m - 20 * bound_m, 0.5 * bound_m, 81};
  const auto found = most_likely_edges_m(
      [&](double) { return signal; }, first_m, drawn_sticks(at.value, kDraws, 11), search);
  DrawnResult result;
  for (const double edge_m : found) {
    const double error = (edge_m - kOracleEdge_m) / bound_m;
    result.ratio += error * error / kDraws;
    result.bias += error / kDraws;
  }
  result.ratio = std::sqrt(result.ratio);
  return result;
}

TEST(Oracle, ReachesTheBoundOnDrawnSamples) {
  for (const double contrast_db : {30.0, 50.0}) {
    for (const auto order : {&pulse_after_edge, &edge_after_pulse}) {
      const EdgeSignal signal = test_signal(contrast_db, 1e-3, order);
      const DrawnResult result = oracle_on_drawn(signal, -6e-3, 70);
      EXPECT_NEAR(result.ratio, 1, 0.1) << contrast_db << " dB";
      EXPECT_NEAR(result.bias, 0, 0.2) << contrast_db << " dB";  // unbiased only in the limit
    }
  }
}

// 0 dB of contrast and few samples: large errors that the bound does not see.
TEST(Oracle, StaysAboveTheBoundWhereTheEchoIsWeak) {
  EXPECT_GT(oracle_on_drawn(test_signal(0, 0.2e-3), -2e-3, 26).ratio, 1.1);
}

class OnTheSimulator : public testing::TestWithParam<sim::Rung> {};

TEST_P(OnTheSimulator, OracleIsNearTheBound) {
  // Few scatterers in the beam's rim are no Gaussian process: 12 in a cell give 2.3, 50 give 1.8.
  const PlaneBound found = measure_plane_bound({.rung = GetParam(),
                                                .range_m = 75e-3,
                                                .incidence_rad = 40 * kDegree,
                                                .scatterers_per_cell = 100,
                                                .seeds = {1, 2, 3, 4}});
  EXPECT_EQ(found.n, 60);
  // RMS of 60 errors: known to 9 %.
  EXPECT_GT(found.rung_ratio, 0.75);
  EXPECT_LT(found.rung_ratio, GetParam() == sim::Rung::field ? 1.4 : 1.7);
  EXPECT_LT(std::abs(found.oracle_bias_m), 0.5 * found.oracle_rms_m);
}

INSTANTIATE_TEST_SUITE_P(Rungs,
                         OnTheSimulator,
                         testing::Values(sim::Rung::field, sim::Rung::scatterers),
                         [](const auto& test) {
                           return test.param == sim::Rung::field ? "field" : "scatterers";
                         });

}  // namespace
}  // namespace wobblebench::bench
