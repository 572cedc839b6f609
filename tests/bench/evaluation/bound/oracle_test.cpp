// The oracle reaches the bound: on drawn samples, and on sticks of the simulator.
#include "tests/bench/evaluation/bound/oracle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/units.h"
#include "tests/bench/evaluation/bound/plane_oracle.h"
#include "tests/bench/evaluation/bound/bound_samples.h"

namespace wobblebench::bench {
namespace {

struct DrawnResult {
  double ratio = 0;  ///< of the oracle's RMS to the bound
  double bias = 0;   ///< in bounds
};

DrawnResult oracle_on_drawn(const EdgeSignal& signal, double first_m, int samples) {
  constexpr double kEdge_m = 0.03e-3;
  constexpr int kDraws = 1500;
  const auto at = edge_covariance(signal, kEdge_m, first_m, samples);
  const double bound_m = 1 / std::sqrt(covariance_information(at.value, at.derivative));
  const SearchGrid search{kEdge_m - 20 * bound_m, 0.5 * bound_m, 81};
  const auto found = most_likely_edges_m(
      [&](double) { return signal; }, first_m, drawn_sticks(at.value, kDraws, 11), search);
  DrawnResult result;
  for (const double edge_m : found) {
    const double error = (edge_m - kEdge_m) / bound_m;
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

void print_row(const PlaneCell& cell) {
  const PlaneBound b = measure_plane_bound(cell);
  std::printf(
      "| %s | %g | %g° %s | %.3f | %.3f | %.3f | %.3f | %+.3f | %.2f (%.2f–%.2f) | %.2f | %d |\n",
      cell.rung == sim::Rung::field ? "field" : "scatterers",
      cell.range_m / kMillimetre,
      std::round(cell.incidence_rad / kDegree),
      cell.across ? "across" : "in plane",
      b.bound_m / kMillimetre,
      b.rung_bound_m / kMillimetre,
      b.envelope_m / kMillimetre,
      b.oracle_rms_m / kMillimetre,
      b.oracle_bias_m / kMillimetre,
      b.ratio,
      b.ratio_low,
      b.ratio_high,
      b.rung_ratio,
      b.n);
  std::fflush(stdout);
}

// The tables of docs/results/bound.md: --gtest_also_run_disabled_tests --gtest_filter=*BoundTable*
TEST(BoundTable, DISABLED_Print) {
  std::vector<std::uint64_t> seeds(20);
  std::iota(seeds.begin(), seeds.end(), 101);
  for (const auto rung : {sim::Rung::field, sim::Rung::scatterers}) {
    for (const double range_mm : {50.0, 75.0, 100.0, 130.0}) {
      for (const double incidence_deg : {0.0, 20.0, 40.0, 60.0}) {
        print_row({.rung = rung,
                   .range_m = range_mm * kMillimetre,
                   .incidence_rad = incidence_deg * kDegree,
                   .seeds = seeds});
      }
      print_row({.rung = rung,
                 .range_m = range_mm * kMillimetre,
                 .incidence_rad = 40 * kDegree,
                 .across = true,
                 .seeds = seeds});
    }
  }
}

TEST(BoundTable, DISABLED_PrintDensities) {
  for (const double per_cell : {6.0, 12.0, 25.0, 50.0, 100.0}) {
    for (const double noise_db : {-95.0, -75.0}) {
      std::printf("%g in a cell, noise %g dB ", per_cell, noise_db);
      print_row({.rung = sim::Rung::scatterers,
                 .range_m = 75e-3,
                 .incidence_rad = 40 * kDegree,
                 .noise_db = noise_db,
                 .scatterers_per_cell = per_cell,
                 .seeds = {101, 102, 103, 104, 105, 106, 107, 108, 109, 110}});
    }
  }
}

}  // namespace
}  // namespace wobblebench::bench
