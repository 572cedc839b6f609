#include "sim/tissue/stick_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "hw/probe/acquisition_plan.h"
#include "phantoms/phantom.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {
namespace {

constexpr double kRadius_m = 20e-3;
constexpr double kDepth_m = 160e-3;

ScannedTissue sphere_tissue(const phantoms::Placement& placement,
                            const phantoms::Motion& motion = {}) {
  static const phantoms::Phantom phantom =
      phantoms::make_phantom({.name = "sphere", .radius_m = kRadius_m});
  static const auto map = std::make_shared<const TissueMap>(phantom, 2e-3, 0);
  return {map, phantom.materials(), placement, motion};
}

/// Ranges at which a ray enters and leaves the sphere, and the cosine of incidence; empty: a miss.
std::vector<double> sphere_crossings(const hw::Ray& ray, const glm::dvec3& center) {
  const glm::dvec3 to_center = center - ray.origin;
  const double along = glm::dot(to_center, ray.direction);
  const double off2 = glm::dot(to_center, to_center) - along * along;
  if (off2 >= kRadius_m * kRadius_m) return {};
  const double half = std::sqrt(kRadius_m * kRadius_m - off2);
  return {along - half, along + half, half / kRadius_m};
}

hw::Ray random_stick(std::mt19937& generator) {
  static const hw::AcquisitionPlan plan({}, {});
  std::uniform_real_distribution<double> angle(-0.35, 0.35);
  return plan.geometry().stick(angle(generator), angle(generator));
}

void expect_crossings(const StickTrack& track, const std::vector<double>& expected) {
  ASSERT_EQ(track.interfaces.size(), 2u);
  for (std::size_t side = 0; side < 2; ++side) {
    // Trilinear interpolation of a curved distance errs by up to voxel^2 / (8 radius) along the
    // normal, more along a grazing ray.
    EXPECT_NEAR(track.interfaces[side].range_m, expected[side], 0.01e-3 / expected[2]);
    EXPECT_NEAR(track.interfaces[side].cos_incidence, expected[2], 0.02);
  }
}

TEST(StickTrack, FindsBothSidesOfASphereFromEveryStick) {
  const phantoms::Placement placement{phantoms::rotation_xyz({0.3, -0.2, 0.1}),
                                      {5e-3, -3e-3, 0.11}};
  const ScannedTissue tissue = sphere_tissue(placement);
  std::mt19937 generator(1);
  StickTrack track;
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const hw::Ray stick = random_stick(generator);
    follow(tissue, {stick, 0}, kDepth_m, track);
    const auto expected = sphere_crossings(stick, placement.position_m);
    if (expected.empty() || expected[1] - expected[0] < 2e-3) continue;
    ++hits;
    expect_crossings(track, expected);
  }
  EXPECT_GT(hits, 100);
}

TEST(StickTrack, CoversTheStickWithoutGaps) {
  const ScannedTissue tissue = sphere_tissue({glm::dmat3(1.0), {0, 0, 0.11}});
  std::mt19937 generator(2);
  StickTrack track;
  for (int i = 0; i < 200; ++i) {
    follow(tissue, {random_stick(generator), 0}, kDepth_m, track);
    EXPECT_EQ(track.stretches.front().from_m, 0);
    EXPECT_EQ(track.stretches.back().to_m, kDepth_m);
    EXPECT_EQ(track.stretches.size(), track.interfaces.size() + 1);
    for (std::size_t s = 1; s < track.stretches.size(); ++s) {
      EXPECT_EQ(track.stretches[s - 1].to_m, track.stretches[s].from_m);
      EXPECT_EQ(track.interfaces[s - 1].before, track.stretches[s - 1].material);
      EXPECT_EQ(track.interfaces[s - 1].behind, track.stretches[s].material);
    }
    EXPECT_EQ(track.pieces.front().from_m, 0);
    EXPECT_NEAR(track.pieces.back().to_m, kDepth_m, 1e-12);
    for (std::size_t p = 1; p < track.pieces.size(); ++p) {
      EXPECT_NEAR(track.pieces[p - 1].to_m, track.pieces[p].from_m, 1e-12);
    }
  }
}

/// Without the surfaces that the stick does not cross, interfaces are the same.
TEST(StickTrack, CrossesTheSameSurfacesWithoutThoseNearby) {
  const ScannedTissue tissue = sphere_tissue({glm::dmat3(1.0), {0, 0, 0.11}});
  std::mt19937 generator(9);
  StickTrack all, crossed;
  std::size_t interfaces = 0;
  for (int i = 0; i < 500; ++i) {
    const hw::Ray stick = random_stick(generator);
    follow(tissue, {stick, 0}, kDepth_m, all);
    follow(tissue, {stick, 0}, kDepth_m, crossed, Surfaces::crossed);
    ASSERT_EQ(crossed.interfaces.size(), all.interfaces.size());
    for (std::size_t k = 0; k < all.interfaces.size(); ++k) {
      EXPECT_EQ(crossed.interfaces[k].range_m, all.interfaces[k].range_m);
      EXPECT_EQ(crossed.interfaces[k].behind, all.interfaces[k].behind);
      EXPECT_EQ(crossed.interfaces[k].cos_incidence, all.interfaces[k].cos_incidence);
    }
    interfaces += all.interfaces.size();
  }
  EXPECT_GT(interfaces, 200u);
}

/// Rounding assigns a surface on a wall between two cells to either of them.
TEST(StickTrack, CrossesASurfaceOnAWallOfTheMapOnce) {
  const hw::AcquisitionPlan plan({}, {});
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> angle(-0.1, 0.1);
  for (const double thickness_m : {2e-3, 3e-3, 4e-3, 6e-3}) {
    const auto plate = phantoms::make_phantom({.name = "bone_plate", .thickness_m = thickness_m});
    const auto map = std::make_shared<const TissueMap>(plate, 2e-3, 0);
    for (const double front_m : {0.08, 0.0813}) {
      const ScannedTissue tissue{map, plate.materials(), {glm::dmat3(1.0), {0, 0, front_m}}, {}};
      StickTrack track;
      for (int i = 0; i < 300; ++i) {
        const hw::Ray stick = plan.geometry().stick(angle(generator), angle(generator));
        for (const Surfaces surfaces : {Surfaces::nearby, Surfaces::crossed}) {
          follow(tissue, {stick, 0}, kDepth_m, track, surfaces);
          ASSERT_EQ(track.interfaces.size(), 2u) << thickness_m << ", stick " << i;
          for (std::size_t side = 0; side < 2; ++side) {
            const double face_m = front_m + (side == 0 ? 0 : thickness_m);
            const double expected_m = (face_m - stick.origin.z) / stick.direction.z;
            EXPECT_NEAR(track.interfaces[side].range_m, expected_m, 1e-6);
            EXPECT_NEAR(track.interfaces[side].cos_incidence, stick.direction.z, 1e-3);
          }
        }
      }
    }
  }
}

TEST(StickTrack, MovingTissueIsWhereItIsAtTheTimeOfTheStick) {
  phantoms::MotionOptions moving;
  moving.velocity_m_s = {20e-3, -10e-3, 15e-3};
  const phantoms::Placement placement{glm::dmat3(1.0), {0, 0, 0.11}};
  const ScannedTissue tissue = sphere_tissue(placement, phantoms::Motion(moving, {}));
  std::mt19937 generator(4);
  std::uniform_real_distribution<double> moment(0, 0.5);
  StickTrack track;
  for (int i = 0; i < 200; ++i) {
    const double time_s = moment(generator);
    const hw::Ray stick = random_stick(generator);
    follow(tissue, {stick, time_s}, kDepth_m, track);
    const glm::dvec3 shift(moving.velocity_m_s[0], moving.velocity_m_s[1], moving.velocity_m_s[2]);
    const auto expected = sphere_crossings(stick, placement.position_m + time_s * shift);
    if (expected.empty() || expected[1] - expected[0] < 2e-3) continue;
    expect_crossings(track, expected);
  }
}

TEST(StickTrack, NonRigidMotionMovesTheTissue) {
  // The whole sphere lies within the rigid part of the head: it stays a sphere whose centre moves.
  const glm::dvec3 pivot(0, 30e-3, 0);
  phantoms::MotionOptions turning;
  turning.head_turn_rad = 20 * kDegree;
  turning.head_turn_period_s = 1;
  turning.head_axis = phantoms::HeadAxis::tilt;
  const phantoms::Motion motion(turning, phantoms::Joint{pivot, 55e-3, 70e-3});
  ASSERT_FALSE(motion.rigid());
  const phantoms::Placement placement{glm::dmat3(1.0), {0, 0, 0.11}};
  const ScannedTissue tissue = sphere_tissue(placement, motion);
  std::mt19937 generator(6);
  std::uniform_real_distribution<double> moment(0, 1);
  StickTrack track;
  int hits = 0;
  for (int i = 0; i < 200; ++i) {
    const double time_s = moment(generator);
    const hw::Ray stick = random_stick(generator);
    follow(tissue, {stick, time_s}, kDepth_m, track);
    const glm::dvec3 center = placement.to_probe(motion.from_rest(glm::dvec3(0), time_s));
    const auto expected = sphere_crossings(stick, center);
    if (expected.empty() || expected[1] - expected[0] < 2e-3) continue;
    ++hits;
    expect_crossings(track, expected);
  }
  EXPECT_GT(hits, 40);
}

TEST(StickTrack, AcrossTheStickIsWhereAnglesGrow) {
  const hw::AcquisitionPlan plan({}, {});
  const auto geometry = plan.geometry();
  for (const auto& [theta, phi] : {std::pair{0.0, 0.0}, {0.4, -0.3}, {-0.6, 0.5}}) {
    const auto across = across_stick(geometry.stick(theta, phi));
    const double step = 1e-6;
    const glm::dvec3 by_theta =
        geometry.stick(theta + step, phi).direction - geometry.stick(theta - step, phi).direction;
    const glm::dvec3 by_phi =
        geometry.stick(theta, phi + step).direction - geometry.stick(theta, phi - step).direction;
    EXPECT_LT(glm::distance(glm::normalize(by_theta), across.lateral), 1e-9);
    EXPECT_LT(glm::distance(glm::normalize(by_phi), across.elevation), 1e-9);
  }
}

}  // namespace
}  // namespace wobblebench::sim
