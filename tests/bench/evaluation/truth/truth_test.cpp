// True surface per pixel, against closed forms of sphere and plane.
#include "bench/evaluation/truth/truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <vector>

#include "bench/scene/resolved_scene.h"
#include "phantoms/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {
namespace {

ResolvedScene stage(const std::vector<std::string>& settings) {
  Scene scene = load_scene({}, settings);
  scene.render.ray_casting.image_size = 64;
  const auto phantom = phantoms::make_phantom(scene.phantom);
  return resolve_scene(std::move(scene), phantom);
}

Truth truth_of(const ResolvedScene& scene) {
  return trace_truth(*scene.subject(), scene.plan(), scene.view());
}

TEST(Truth, SphereIsWhereItsEquationSays) {
  for (const std::string view :
       {"render.view.yaw_deg=0", "render.view.yaw_deg=35", "render.view.pitch_deg=-25"}) {
    const ResolvedScene s = stage(
        {"phantom.name=sphere", "phantom.radius_mm=18", view, "placement.rotation_deg=[10,20,30]"});
    const Truth truth = truth_of(s);
    const render::Camera camera = s.view().camera;
    const glm::dvec3 center = s.subject()->placement.position_m;
    int compared = 0;
    for (int row = 0; row < 64; ++row) {
      for (int column = 0; column < 64; ++column) {
        const hw::Ray ray = camera.ray(column, row);
        const double along = glm::dot(center - ray.origin, ray.direction);
        const double off = glm::length(ray.at(along) - center);
        // At the rim the voxels' round-off decides between hit and miss.
        if (off > 17.5e-3) continue;
        const double expected = along - std::sqrt(18e-3 * 18e-3 - off * off);
        const auto span = render::clip_to_box(ray, s.render().volume_of_interest);
        if (expected < span.from_m + 0.1e-3 || expected > span.to_m - 0.1e-3) continue;
        const bool seen = truth.kind.at(column, row) == TruthKind::surface;
        ASSERT_TRUE(seen || truth.kind.at(column, row) == TruthKind::grazing)
            << column << " " << row;
        ASSERT_EQ(std::isnan(truth.depth_m.at(column, row)), !seen);
        ASSERT_NEAR(truth.crossing_m.at(column, row), expected, 0.03e-3);
        const glm::dvec3 normal = glm::normalize(ray.at(expected) - center);
        ASSERT_GT(glm::dot(glm::dvec3(truth.normal.at(column, row)), normal), 0.999);
        ++compared;
      }
    }
    EXPECT_GT(compared, 100);
  }
}

double cut_percent(const ResolvedScene& scene) {
  return cut_by_box_percent(*scene.subject(), scene.plan(), scene.view());
}

/// By symmetry: a box that ends at the ball's middle cuts half of what is seen off, and one that
/// ends there to two sides three quarters.
TEST(Truth, WhatTheBoxCutsOffABallIsAShareOfItsArea) {
  const auto cut = [](const std::string& center_mm) {
    return cut_percent(stage({"phantom.name=sphere",
                              "phantom.radius_mm=15",
                              "placement.position_mm=[0,0,110]",
                              "render.volume_of_interest.size_mm=[60,60,60]",
                              "render.volume_of_interest.center_mm=" + center_mm}));
  };
  EXPECT_EQ(cut("[0,0,110]"), 0);
  EXPECT_NEAR(cut("[-30,0,110]"), 50, 0.5);
  EXPECT_NEAR(cut("[30,-30,110]"), 75, 0.5);
}

/// Of a head that turns the box leaves nothing out, and the default's box stays where it was.
TEST(Truth, TheBoxFollowsTheHeadsPose) {
  const auto head = [](const std::string& yaw, const std::string& pitch, const std::string& roll) {
    return stage({"phantom.voxel_mm=2",
                  "phantom.head_yaw_deg=" + yaw,
                  "phantom.head_pitch_deg=" + pitch,
                  "phantom.head_roll_deg=" + roll});
  };
  for (const auto& [yaw, pitch, roll] : {std::array{"-40", "-4", "-5"},
                                         std::array{"18", "-4", "-5"},
                                         std::array{"40", "-4", "-5"},
                                         std::array{"8", "-4", "40"},
                                         std::array{"20", "-30", "-40"}}) {
    EXPECT_LT(cut_percent(head(yaw, pitch, roll)), 0.15) << yaw << " " << pitch << " " << roll;
  }
  const ResolvedScene still = head("8", "-4", "-5");
  EXPECT_EQ(cut_percent(still), 0);
  const glm::dvec3 size_m = still.render().volume_of_interest.size_m;
  EXPECT_NEAR(glm::distance(size_m, {80e-3, 94.8533833046e-3, 60e-3}), 0, 1e-9);
}

TEST(Truth, FallingEdgeOfASphereIsItsBack) {
  const ResolvedScene s = stage({"phantom.name=sphere",
                                 "phantom.radius_mm=15",
                                 "render.ray_casting.edge=falling",
                                 "render.volume_of_interest.size_mm=[60,60,90]",
                                 "render.volume_of_interest.center_mm=[0,0,110]"});
  const Truth truth = truth_of(s);
  const render::Camera camera = s.view().camera;
  const glm::dvec3 center = s.subject()->placement.position_m;
  const hw::Ray ray = camera.ray(32, 32);
  const double along = glm::dot(center - ray.origin, ray.direction);
  const double off = glm::length(ray.at(along) - center);
  EXPECT_NEAR(truth.depth_m.at(32, 32), along + std::sqrt(15e-3 * 15e-3 - off * off), 0.03e-3);
}

TEST(Truth, TiltedPlaneIsWhereItsEquationSays) {
  const ResolvedScene s =
      stage({"phantom.name=plane", "phantom.tilt_x_deg=15", "phantom.tilt_y_deg=-10"});
  const Truth truth = truth_of(s);
  const render::Camera camera = s.view().camera;
  const glm::dvec3 origin = s.subject()->placement.position_m;
  const glm::dvec3 n =
      phantoms::rotation_xyz({15 * kDegree, -10 * kDegree, 0}) * glm::dvec3(0, 0, -1);
  int compared = 0;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      if (truth.kind.at(column, row) != TruthKind::surface) continue;
      const hw::Ray ray = camera.ray(column, row);
      const double expected = glm::dot(origin - ray.origin, n) / glm::dot(ray.direction, n);
      ASSERT_NEAR(truth.depth_m.at(column, row), expected, 0.01e-3);
      ++compared;
    }
  }
  EXPECT_GT(compared, 2000);
}

TEST(Truth, SurfacesOutsideTheFieldAreSeparate) {
  const ResolvedScene s = stage({"phantom.name=plane", "acquisition.sector_deg=20"});
  const Truth truth = truth_of(s);
  int outside = 0, visible = 0;
  const render::Camera camera = s.view().camera;
  const auto geometry = s.plan().geometry();
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const TruthKind kind = truth.kind.at(column, row);
      outside += kind == TruthKind::outside_field;
      if (kind != TruthKind::surface) continue;
      ++visible;
      const auto p = geometry.to_polar(
          camera.ray(column, row).at(static_cast<double>(truth.depth_m.at(column, row))));
      EXPECT_LE(std::abs(p.theta_rad), 10 * kDegree + 1e-6);
    }
  }
  EXPECT_GT(outside, 500);
  EXPECT_GT(visible, 200);
}

/// Time of the stick that images a position: stepped motor, 64 lines over 77 deg, 37 frames over
/// 61 deg, 2 x 0.16 m / 1540 m/s each.
double stick_time_s(const hw::ProbeGeometry& geometry, const glm::dvec3& position) {
  const hw::PolarPoint p = geometry.to_polar(position);
  const auto index = [](double angle_rad, double span_deg, int count) {
    const double at = (angle_rad / kDegree / span_deg + 0.5) * (count - 1);
    return std::clamp(std::round(at), 0.0, count - 1.0);
  };
  return (index(p.phi_rad, 61, 37) * 64 + index(p.theta_rad, 77, 64)) * 2 * 0.16 / 1540;
}

struct MovingSphere {
  std::string velocity_mm_s;
  std::string view;
};

class TruthOfMovingSphere : public testing::TestWithParam<MovingSphere> {};

TEST_P(TruthOfMovingSphere, IsWhereItWasWhenItsSticksWereFired) {
  const ResolvedScene s = stage({"phantom.name=sphere",
                                 "phantom.radius_mm=18",
                                 "placement.rotation_deg=[10,20,30]",
                                 "motion.velocity_mm_s=" + GetParam().velocity_mm_s,
                                 GetParam().view});
  const Truth truth = truth_of(s);
  const render::Camera camera = s.view().camera;
  const auto geometry = s.plan().geometry();
  const auto placement = s.subject()->placement;
  const auto& v = s.options().motion.velocity_m_s;
  const glm::dvec3 velocity = placement.direction_to_probe({v[0], v[1], v[2]});
  const auto center_at = [&](double time_s) { return placement.position_m + time_s * velocity; };
  const auto outside = [&](const glm::dvec3& position) {
    return glm::distance(position, center_at(stick_time_s(geometry, position))) > 18e-3;
  };
  const double frame_step_m = glm::length(velocity) * 64 * 2 * 0.16 / 1540;
  int compared = 0, at_a_step = 0, at_an_edge = 0;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const auto span = render::clip_to_box(ray, s.render().volume_of_interest);
      double expected = span.from_m;
      while (expected < span.to_m && outside(ray.at(expected))) expected += 20e-6;
      if (expected >= span.to_m - 0.1e-3 || expected < span.from_m + 0.1e-3) continue;
      const glm::dvec3 position = ray.at(expected);
      const glm::dvec3 center = center_at(stick_time_s(geometry, position));
      const double along = glm::dot(center - ray.origin, ray.direction);
      const double off = glm::distance(ray.at(along), center);
      if (off > 17e-3 || truth.kind.at(column, row) == TruthKind::outside_field) continue;
      ASSERT_NE(truth.kind.at(column, row), TruthKind::none) << column << " " << row;
      ++compared;
      const double off_m = std::abs(truth.crossing_m.at(column, row) - expected);
      // At the edge of a frame the grid's rounding may decide whether the surface is in it.
      if (off_m > 0.05e-3 && off_m < 0.05e-3 + frame_step_m) {
        ++at_an_edge;
        continue;
      }
      ASSERT_LE(off_m, 0.05e-3) << column << " " << row;
      // The sphere, displaced by its velocity times the time of the stick, except at the step
      // between a frame that misses it and the next one.
      const double shifted = along - std::sqrt(18e-3 * 18e-3 - off * off);
      if (std::abs(shifted - expected) > 0.05e-3) {
        ++at_a_step;
        continue;
      }
      const glm::dvec3 normal = glm::normalize(position - center);
      ASSERT_GT(glm::dot(glm::dvec3(truth.normal.at(column, row)), normal), 0.998);
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_LE(at_an_edge, compared / 150);
  EXPECT_LE(at_a_step, compared / 20);
}

INSTANTIATE_TEST_SUITE_P(Velocities,
                         TruthOfMovingSphere,
                         testing::Values(MovingSphere{"[10,0,0]", "render.view.yaw_deg=0"},
                                         MovingSphere{"[0,10,0]", "render.view.yaw_deg=0"},
                                         MovingSphere{"[0,0,10]", "render.view.yaw_deg=0"},
                                         MovingSphere{"[0,0,-10]", "render.view.pitch_deg=20"},
                                         MovingSphere{"[15,-20,25]", "render.view.yaw_deg=30"}));

/// A recording may be played from a later volume on.
TEST(Truth, LaterVolumesAreThoseOfTheirOwnTime) {
  const ResolvedScene s =
      stage({"phantom.name=sphere", "phantom.radius_mm=18", "motion.velocity_mm_s=[0,0,5]"});
  const auto plan = s.plan();
  const auto view = s.view();
  const auto depth_m = [&](std::uint32_t volume) {
    return trace_truth(*s.subject(), plan, view, volume).depth_m.at(32, 32);
  };
  const double volume_s = 37 * 64 * 2 * 0.16 / 1540;
  EXPECT_NEAR(depth_m(3) - depth_m(0), 3 * volume_s * 5e-3, 0.05e-3);
}

TEST(Truth, NoFastSphereIsSteppedOver) {
  // Viewed across the sweep: a ray crosses frame after frame, with the sphere displaced in each.
  const ResolvedScene s = stage({"phantom.name=sphere",
                                 "phantom.radius_mm=4",
                                 "motion.velocity_mm_s=[0,0,120]",
                                 "placement.position_mm=[0,0,90]",
                                 "render.volume_of_interest.center_mm=[0,0,110]",
                                 "render.volume_of_interest.size_mm=[60,80,80]",
                                 "render.view.pitch_deg=90"});
  const Truth truth = truth_of(s);
  const render::Camera camera = s.view().camera;
  const auto geometry = s.plan().geometry();
  const auto inside = [&](const glm::dvec3& position) {
    const glm::dvec3 center(0, 0, 90e-3 + 120e-3 * stick_time_s(geometry, position));
    return glm::distance(position, center) < 4e-3;
  };
  int compared = 0, different = 0;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const auto span = render::clip_to_box(ray, s.render().volume_of_interest);
      double expected = span.from_m;
      while (expected < span.to_m && !inside(ray.at(expected))) expected += 20e-6;
      if (truth.kind.at(column, row) == TruthKind::outside_field) continue;
      const bool none = truth.kind.at(column, row) == TruthKind::none;
      if (expected >= span.to_m && none) continue;
      ++compared;
      const double depth = static_cast<double>(truth.crossing_m.at(column, row));
      different += none || !(std::abs(depth - expected) < 0.05e-3);
    }
  }
  EXPECT_GT(compared, 30);
  EXPECT_LE(different, compared / 20) << "at its rim the grid decides whether it is there";
}

/// The first position along a ray where ray marching in tiny steps enters tissue.
std::optional<double> march_finely(const hw::Ray& ray,
                                   const render::Span& span,
                                   const ResolvedScene& s,
                                   const phantoms::SurfaceFinder& finder,
                                   const phantoms::Motion& motion) {
  const auto geometry = s.plan().geometry();
  const auto placement = s.subject()->placement;
  std::vector<double> before;
  for (double at = span.from_m; at < span.to_m; at += 50e-6) {
    const glm::dvec3 position = ray.at(at);
    const glm::dvec3 rest =
        motion.to_rest(placement.to_phantom(position), stick_time_s(geometry, position));
    std::vector<double> now;
    for (int t = 0; t < finder.targets(); ++t) now.push_back(finder.distance_bound(t, rest));
    for (std::size_t t = 0; t < before.size(); ++t) {
      const auto surface = static_cast<std::size_t>(finder.surface(static_cast<int>(t)));
      const auto inside = static_cast<std::size_t>(s.subject()->phantom.surfaces()[surface].inside);
      const bool tissue = s.subject()->phantom.materials()[inside].backscatter_db > -100;
      if ((before[t] < 0) != (now[t] < 0) && (now[t] < 0) == tissue) return at - 25e-6;
    }
    before = std::move(now);
  }
  return std::nullopt;
}

using Settings = std::vector<std::string>;

class TruthOfMovingFace : public testing::TestWithParam<Settings> {};

TEST_P(TruthOfMovingFace, IsThatOfAFineRayMarch) {
  Settings settings = {"phantom.voxel_mm=1", "phantom.maternal_layer_mm=0"};
  settings.insert(settings.end(), GetParam().begin(), GetParam().end());
  const ResolvedScene s = stage(settings);
  const Truth truth = truth_of(s);
  const render::Camera camera = s.view().camera;
  const phantoms::SurfaceFinder finder(s.subject()->phantom);
  const auto motion = s.subject()->motion;
  int compared = 0, different = 0;
  for (int row = 1; row < 64; row += 3) {
    for (int column = 1; column < 64; column += 3) {
      const hw::Ray ray = camera.ray(column, row);
      const auto span = render::clip_to_box(ray, s.render().volume_of_interest);
      const auto expected = march_finely(ray, span, s, finder, motion);
      if (truth.kind.at(column, row) == TruthKind::outside_field) continue;
      ++compared;
      const double crossing = truth.crossing_m.at(column, row);
      const bool same = expected ? std::abs(crossing - *expected) < 0.05e-3
                                 : truth.kind.at(column, row) == TruthKind::none;
      different += !same;
    }
  }
  EXPECT_GT(compared, 200);
  // Grazing rays may miss a ridge thinner than a step.
  EXPECT_LE(different, compared / 100);
}

INSTANTIATE_TEST_SUITE_P(Motions,
                         TruthOfMovingFace,
                         testing::Values(Settings{"motion.velocity_mm_s=[0,0,1e-6]"},
                                         Settings{"motion.velocity_mm_s=[20,10,-30]"},
                                         Settings{"motion.turn_rate_deg_s=[0,40,0]"},
                                         Settings{"motion.breath_amplitude_mm=10"},
                                         Settings{"motion.velocity_mm_s=[0,-200,-60]"},
                                         Settings{"motion.head_turn_deg=40"},
                                         Settings{"phantom.mouth_open_mm=6",
                                                  "motion.mouth_close_mm=5.1",
                                                  "motion.mouth_period_s=0.5",
                                                  "motion.head_turn_deg=20"}));

TEST(Truth, RayMarchingAgreesWithOpenVdbForNegligibleMotion) {
  const ResolvedScene still = stage({"phantom.voxel_mm=1", "phantom.maternal_layer_mm=0"});
  const ResolvedScene crawling = stage(
      {"phantom.voxel_mm=1", "phantom.maternal_layer_mm=0", "motion.velocity_mm_s=[0,0,1e-6]"});
  const Truth exact = truth_of(still), marched = truth_of(crawling);
  int compared = 0, different = 0;
  for (std::size_t i = 0; i < exact.kind.pixels.size(); ++i) {
    if (exact.kind.pixels[i] != TruthKind::surface) continue;
    ++compared;
    const double off = static_cast<double>(exact.depth_m.pixels[i] - marched.depth_m.pixels[i]);
    // A miss is infinitely far off.
    different += !(std::abs(off) < 0.03e-3);
  }
  EXPECT_GT(compared, 1000);
  EXPECT_LE(different, compared / 100);
}

TEST(Truth, SpeckleBlockHasNoSurface) {
  const Truth truth = truth_of(stage({"phantom.name=speckle_block", "phantom.voxel_mm=2"}));
  for (const TruthKind kind : truth.kind.pixels) ASSERT_EQ(kind, TruthKind::none);
}

}  // namespace
}  // namespace wobblebench::bench
