#include "hw/probe/probe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "base/options.h"
#include "tests/hw/support/streams.h"
#include "tests/support/expect.h"

namespace wobblebench::hw {
namespace {

constexpr double kTolerance_m = 1e-9;

ProbeGeometry geometry(double radius_m, double wobble_radius_m) {
  ProbeOptions options;
  options.radius_m = radius_m;
  options.wobble_radius_m = wobble_radius_m;
  return ProbeGeometry(options);
}

/// Both directions: the same position, and the same polar coordinates.
void expect_round_trip(const ProbeGeometry& probe, const PolarPoint& point) {
  const glm::dvec3 position = probe.to_cartesian(point);
  const PolarPoint back = probe.to_polar(position);
  const double r_m = probe.radius_m() + point.range_m;
  const double axis_distance_m = r_m * std::cos(point.theta_rad) - probe.axis_z_m();
  ASSERT_NEAR(glm::distance(probe.to_cartesian(back), position), 0, kTolerance_m);
  ASSERT_NEAR(back.range_m, point.range_m, kTolerance_m);
  ASSERT_NEAR(back.theta_rad * r_m, point.theta_rad * r_m, kTolerance_m);
  ASSERT_NEAR(back.phi_rad * axis_distance_m, point.phi_rad * axis_distance_m, kTolerance_m);
}

TEST(ProbeGeometry, RoundTripsOverTheWholeFieldOfManyProbes) {
  for (const double radius_m : {5e-3, 40e-3, 60e-3, 200e-3}) {
    for (const double share : {0.0, 0.01, 0.3, 0.675, 0.99, 1.0, 1.4, 4.0}) {
      const ProbeGeometry probe = geometry(radius_m, std::min(share * radius_m, 0.2));
      for (double range_m = 0; range_m <= 0.4; range_m += 0.05) {
        for (int theta_deg = -85; theta_deg <= 85; theta_deg += 17) {
          for (int phi_deg = -85; phi_deg <= 85; phi_deg += 17) {
            expect_round_trip(probe, {range_m, theta_deg * kDegree, phi_deg * kDegree});
          }
        }
      }
    }
  }
}

TEST(ProbeGeometry, RoundTripsAtRandom) {
  for (std::uint64_t i = 0; i < 200000; ++i) {
    const double radius_m = uniform(1, i, 1e-3, 0.2);
    const ProbeGeometry probe = geometry(radius_m, uniform(2, i, 0, 0.2));
    expect_round_trip(probe,
                      {uniform(3, i, 0, 0.4),
                       uniform(4, i, -85 * kDegree, 85 * kDegree),
                       uniform(5, i, -85 * kDegree, 85 * kDegree)});
  }
}

TEST(ProbeGeometry, PointsBehindTheWobbleAxis) {
  // w = 0: at 60 degrees the face lies at r cos(theta) = a / 2 < b = a.
  const ProbeGeometry probe = geometry(40e-3, 0);
  const PolarPoint point{0, 60 * kDegree, 20 * kDegree};
  const glm::dvec3 position = probe.to_cartesian(point);
  EXPECT_LT(position.z, probe.axis_z_m());
  EXPECT_GT(position.y, 0) << "behind the axis the plane moves in the opposite direction";
  expect_round_trip(probe, point);
}

TEST(ProbeGeometry, EqualsThePublishedFormula) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const double a = uniform(6, i, 5e-3, 0.1);
    const double b = a - uniform(7, i, 0, a);
    const double r = a + uniform(8, i, 0, 0.3);
    const double theta = uniform(9, i, -1.4, 1.4), phi = uniform(10, i, -1.4, 1.4);
    const glm::dvec3 position = geometry(a, a - b).to_cartesian({r - a, theta, phi});
    EXPECT_NEAR(position.x, r * std::sin(theta), 1e-15);
    EXPECT_NEAR(position.y, -(r * std::cos(theta) - b) * std::sin(phi), 1e-15);
    EXPECT_NEAR(position.z, b * (1 - std::cos(phi)) + r * std::cos(theta) * std::cos(phi), 1e-15);
  }
}

TEST(ProbeGeometry, WobbleAxisMayBeOnTheFaceOrAtTheCentre) {
  const glm::dvec3 apex = geometry(40e-3, 0).to_cartesian({0, 0, 0.5});
  EXPECT_NEAR(glm::distance(apex, glm::dvec3(0, 0, 40e-3)), 0, 1e-15);
  const glm::dvec3 on_sphere = geometry(40e-3, 40e-3).to_cartesian({60e-3, 0.4, -0.7});
  EXPECT_NEAR(glm::length(on_sphere), 100e-3, 1e-15);
}

TEST(ProbeGeometry, SamplesLieOnTheStick) {
  const ProbeGeometry probe = geometry(40e-3, 27e-3);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const double theta = uniform(11, i, -1.4, 1.4), phi = uniform(12, i, -1.4, 1.4);
    const double range_m = uniform(13, i, 0, 0.3);
    const Ray stick = probe.stick(theta, phi);
    EXPECT_NEAR(glm::length(stick.direction), 1, 1e-14);
    EXPECT_NEAR(
        glm::distance(stick.at(range_m), probe.to_cartesian({range_m, theta, phi})), 0, 1e-14);
  }
}

TEST(ProbeGeometry, PhiIsZeroOnTheWobbleAxis) {
  const ProbeGeometry probe = geometry(40e-3, 27e-3);
  const PolarPoint point = probe.to_polar({0.03, 0, probe.axis_z_m()});
  EXPECT_EQ(point.phi_rad, 0);
  EXPECT_NEAR(glm::distance(probe.to_cartesian(point), glm::dvec3(0.03, 0, 0.013)), 0, 1e-15);
}

std::string rejection(const ProbeOptions& options) {
  return refusal_of<InvalidOption>([&] { validate(options); });
}

TEST(ProbeOptions, DefaultsPass) {
  EXPECT_EQ(rejection({}), "");
}

TEST(ProbeOptions, RejectionNamesKeyValueAndRange) {
  ProbeOptions wobble;
  wobble.wobble_radius_m = 201e-3;
  EXPECT_EQ(rejection(wobble), "wobble_radius_mm = 201: must be within 0 and 200");
  ProbeOptions radius;
  radius.radius_m = 0;
  EXPECT_EQ(rejection(radius), "radius_mm = 0: must be within 1 and 200");
  ProbeOptions frequency;
  frequency.center_frequency_hz = NAN;
  EXPECT_EQ(rejection(frequency), "center_frequency_mhz = nan: must be within 0.5 and 20");
  ProbeOptions bandwidth;
  bandwidth.fractional_bandwidth = INFINITY;
  EXPECT_EQ(rejection(bandwidth), "fractional_bandwidth = inf: must be within 0.1 and 1.5");
  ProbeOptions pitch;
  pitch.pitch_m = 0.01e-3;
  EXPECT_EQ(rejection(pitch), "pitch_mm = 0.01: must be within 0.05 and 2");
  ProbeOptions focus;
  focus.transmit_focus_m = 401e-3;
  EXPECT_EQ(rejection(focus), "transmit_focus_mm = 401: must be within 5 and 400");
  ProbeOptions elements;
  elements.elements = 0;
  EXPECT_EQ(rejection(elements), "elements = 0: must be within 1 and 1024");
  EXPECT_THROW(ProbeGeometry{wobble}, InvalidOption);
}

}  // namespace
}  // namespace wobblebench::hw
