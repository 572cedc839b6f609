// The bound against closed forms and the laws that it must follow.
#include "bench/evaluation/bound/detection_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "base/units.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"
#include "tests/bench/evaluation/bound/oracle.h"

namespace wobblebench::bench {
namespace {

DetectionConditions lone_stick() {
  DetectionConditions conditions;
  conditions.incidence_rad = 40 * kDegree;
  conditions.line_spacing_m = conditions.frame_spacing_m = 1;
  return conditions;
}

// Echo far below the noise: F = sum (T/N c g)^2 over pairs of samples, as an integral
// (T/N)^2 sigma / (sqrt 2 w s^2), with the pulse's sigma, the rise's w and the spacing s.
TEST(DetectionBound, FarBelowTheNoiseIsAClosedForm) {
  DetectionConditions weak = lone_stick();
  weak.noise_db = weak.tissue_db + 29;
  const double pulse_m = sim::sigma_of_fwhm(weak.pulse_fwhm_m), s = weak.sample_spacing_m;
  const double ratio = std::pow(10.0, -2.9);
  const double information =
      ratio * ratio * pulse_m / (std::sqrt(2.0) * rise_sigma_m(weak) * s * s);
  EXPECT_NEAR(detection_bound_m(weak) * std::sqrt(information), 1, 0.01);
}

TEST(DetectionBound, HalvesWithTwiceTheContrastFarBelowTheNoise) {
  DetectionConditions weak = lone_stick();
  weak.noise_db = weak.tissue_db + 29;
  DetectionConditions twice = weak;
  twice.tissue_db += 10 * std::log10(2.0);
  EXPECT_NEAR(detection_bound_m(weak) / detection_bound_m(twice), 2, 0.01);
}

// By the second difference of the relative entropy between surfaces 0.2 % of the rise apart, in
// numpy with its own covariance.
TEST(DetectionBound, IsThatOfAnotherComputation) {
  struct Case {
    double incidence_deg, noise_db, bound_mm;
  };
  for (const Case& known : {Case{0, -95, 0.015164},
                            Case{0, -70, 0.033154},
                            Case{40, -95, 0.050938},
                            Case{40, -70, 0.097830},
                            Case{60, -95, 0.072735},
                            Case{60, -70, 0.139886}}) {
    DetectionConditions conditions = lone_stick();
    conditions.incidence_rad = known.incidence_deg * kDegree;
    conditions.noise_db = known.noise_db;
    EXPECT_NEAR(detection_bound_m(conditions) / kMillimetre / known.bound_mm, 1, 5e-3)
        << known.incidence_deg << " " << known.noise_db;
  }
}

// Twice the samples with noise of the same density are the same signal, once the rate holds it.
TEST(DetectionBound, DependsOnTheDensityOfTheNoiseNotOnTheSampleRate) {
  for (const double noise_db : {-95.0, -60.0}) {
    DetectionConditions coarse = lone_stick();
    coarse.sample_spacing_m = 0.08e-3;
    coarse.noise_db = noise_db;
    DetectionConditions fine = coarse;
    fine.sample_spacing_m /= 2;
    fine.noise_db += 10 * std::log10(2.0);
    EXPECT_NEAR(detection_bound_m(fine) / detection_bound_m(coarse), 1, 0.01);
  }
}

TEST(DetectionBound, IsALength) {
  const DetectionConditions conditions = lone_stick();
  DetectionConditions larger = conditions;
  for (double* length : {&larger.lateral_fwhm_m,
                         &larger.elevation_fwhm_m,
                         &larger.pulse_fwhm_m,
                         &larger.sample_spacing_m,
                         &larger.line_spacing_m,
                         &larger.frame_spacing_m}) {
    *length *= 3;
  }
  EXPECT_NEAR(detection_bound_m(larger) / detection_bound_m(conditions), 3, 1e-6);
}

TEST(DetectionBound, DependsOnRatiosOfPowers) {
  DetectionConditions conditions = lone_stick();
  conditions.fluid_db = -70;
  DetectionConditions louder = conditions;
  louder.tissue_db += 17;
  louder.fluid_db += 17;
  louder.noise_db += 17;
  EXPECT_NEAR(detection_bound_m(louder) / detection_bound_m(conditions), 1, 1e-9);
}

TEST(DetectionBound, GrowsWithIncidenceNoiseClutterAndBeam) {
  const DetectionConditions conditions = lone_stick();
  const double bound_m = detection_bound_m(conditions);
  const auto changed = [&](auto change) {
    DetectionConditions other = conditions;
    change(other);
    return detection_bound_m(other);
  };
  EXPECT_GT(changed([](auto& c) { c.incidence_rad = 60 * kDegree; }), bound_m);
  EXPECT_GT(changed([](auto& c) { c.noise_db += 20; }), bound_m);
  EXPECT_GT(changed([](auto& c) { c.fluid_db = -65; }), bound_m);
  EXPECT_GT(changed([](auto& c) { c.lateral_fwhm_m *= 2; }), bound_m);
  // The slope is in the image plane, where the beam's height does not count.
  EXPECT_NEAR(changed([](auto& c) { c.elevation_fwhm_m *= 2; }), bound_m, 1e-9 * bound_m);
  EXPECT_GT(changed([](auto& c) { c.azimuth_rad = 90 * kDegree; }), bound_m);
}

// Samples farther apart than the pulse is long are independent, and their intensities tell all.
TEST(DetectionBound, DetectionLosesNothingOfIndependentSamples) {
  DetectionConditions sparse = lone_stick();
  sparse.sample_spacing_m = 1e-3;
  EXPECT_NEAR(envelope_bound_m(sparse, 1e-3) / detection_bound_m(sparse), 1, 1e-3);
}

TEST(DetectionBound, DetectionLosesSomeOfCorrelatedSamples) {
  const DetectionConditions conditions = lone_stick();
  EXPECT_GT(envelope_bound_m(conditions, 0.3125e-3), detection_bound_m(conditions));
}

TEST(DetectionBound, NeighboursBeyondTheBeamTellNothing) {
  const DetectionConditions apart;  // the default scan
  EXPECT_EQ(neighbour_modes(apart), std::vector<double>{1});
  EXPECT_EQ(detection_bound_m(apart), detection_bound_m([&] {
              DetectionConditions alone = apart;
              alone.line_spacing_m = alone.frame_spacing_m = 1;
              return alone;
            }()));
}

// Three sticks half a width apart: their modes are those of [1 a b; a 1 a; b a 1].
TEST(DetectionBound, NeighboursWithinTheBeamAreModes) {
  DetectionConditions dense = lone_stick();
  dense.line_spacing_m = dense.lateral_fwhm_m / 2 * 0.999;
  const double u = dense.line_spacing_m / (2 * sim::sigma_of_fwhm(dense.lateral_fwhm_m));
  const double a = std::exp(-u * u), b = std::exp(-4 * u * u);
  const auto modes = neighbour_modes(dense);
  ASSERT_EQ(modes.size(), 3U);
  const double root = std::sqrt(b * b + 8 * a * a);
  EXPECT_NEAR(modes[0], 1 + 0.5 * (b - root), 1e-12);
  EXPECT_NEAR(modes[1], 1 - b, 1e-12);
  EXPECT_NEAR(modes[2], 1 + 0.5 * (b + root), 1e-12);
  // Without noise three sticks would tell three times as much, however they correlate.
  const double gain = std::pow(detection_bound_m(lone_stick()) / detection_bound_m(dense), 2);
  EXPECT_GT(gain, 2);
  EXPECT_LT(gain, 3);
}

TEST(DetectionBound, RefusesWhatHasNoBound) {
  const auto refused = [](auto change) {
    DetectionConditions conditions;
    change(conditions);
    EXPECT_THROW(detection_bound_m(conditions), std::invalid_argument);
  };
  refused([](auto& c) { c.noise_db = -200; });
  refused([](auto& c) { c.noise_db = NAN; });
  refused([](auto& c) { c.tissue_db = -130; });
  refused([](auto& c) { c.fluid_db = c.tissue_db; });
  refused([](auto& c) { c.incidence_rad = 89 * kDegree; });
  refused([](auto& c) { c.incidence_rad = NAN; });
  refused([](auto& c) { c.sample_spacing_m = 0; });
  refused([](auto& c) { c.lateral_fwhm_m = -1; });
}

TEST(DetectionBound, ConditionsAreThoseOfThePlace) {
  const hw::AcquisitionPlan plan({}, {});
  const sim::SimulationOptions options;
  const sim::BeamProfile profile{sim::ProbeOptics(plan, options)};
  const hw::PolarPoint place{.range_m = 75e-3};
  // Tilted by 30 degrees in the image plane: deeper towards +x.
  const glm::dvec3 normal(0.5, 0, -std::sqrt(0.75));
  const auto c = conditions_at(plan, profile, options, place, normal, -45);
  EXPECT_NEAR(c.incidence_rad, 30 * kDegree, 1e-9);
  EXPECT_NEAR(c.azimuth_rad, 0, 1e-9);
  EXPECT_NEAR(c.tissue_db, -45 + 1.0491, 1e-3);
  EXPECT_NEAR(c.line_spacing_m, 0.115 * 77 * kDegree / 63, 1e-9);
  EXPECT_NEAR(c.frame_spacing_m, (0.115 - 0.013) * 61 * kDegree / 36, 1e-9);
  EXPECT_NEAR(c.sample_spacing_m, 0.16 / 512 / 2, 1e-9);
  EXPECT_EQ(c.lateral_fwhm_m, profile.lateral_fwhm_m(75e-3));
  EXPECT_EQ(c.elevation_fwhm_m, profile.elevation_fwhm_m(75e-3));
}

}  // namespace
}  // namespace wobblebench::bench
