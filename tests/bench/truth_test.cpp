// What each pixel should show, against closed forms of sphere and plane.
#include "bench/truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "bench/scene.h"
#include "render/camera.h"

namespace wobblebench::bench {
namespace {

struct Stage {
  Scene scene;
  phantoms::Phantom phantom;
};

Stage stage(const std::vector<std::string>& settings) {
  Scene scene = load_scene({}, settings);
  scene.render.ray_casting.image_size = 64;
  auto phantom = phantoms::make_phantom(scene.phantom);
  complete_from_phantom(scene, phantom);
  return {scene, phantom};
}

Truth truth_of(const Stage& s) {
  return trace_truth(s.phantom, s.scene.phantom_placement(), s.scene.plan(), s.scene.render);
}

TEST(Truth, SphereIsWhereItsEquationSays) {
  for (const std::string view :
       {"render.view.yaw_deg=0", "render.view.yaw_deg=35", "render.view.pitch_deg=-25"}) {
    const Stage s = stage(
        {"phantom.name=sphere", "phantom.radius_mm=18", view, "placement.rotation_deg=[10,20,30]"});
    const Truth truth = truth_of(s);
    const render::Camera camera = render::make_camera(s.scene.render);
    const glm::dvec3 center = s.scene.phantom_placement().position_m;
    int compared = 0;
    for (int row = 0; row < 64; ++row) {
      for (int column = 0; column < 64; ++column) {
        const hw::Ray ray = camera.ray(column, row);
        const double along = glm::dot(center - ray.origin, ray.direction);
        const double off = glm::length(ray.at(along) - center);
        // At the rim the voxels' round-off decides between hit and miss.
        if (off > 17.5e-3) continue;
        const double expected = along - std::sqrt(18e-3 * 18e-3 - off * off);
        const auto span = render::clip_to_box(ray, s.scene.render.volume_of_interest);
        if (expected < span.from_m + 0.1e-3 || expected > span.to_m - 0.1e-3) continue;
        ASSERT_EQ(truth.kind.at(column, row), TruthKind::surface) << column << " " << row;
        ASSERT_NEAR(truth.depth_m.at(column, row), expected, 0.03e-3);
        const glm::dvec3 normal = glm::normalize(ray.at(expected) - center);
        ASSERT_GT(glm::dot(glm::dvec3(truth.normal.at(column, row)), normal), 0.999);
        ++compared;
      }
    }
    EXPECT_GT(compared, 100);
  }
}

TEST(Truth, FallingEdgeOfASphereIsItsBack) {
  const Stage s = stage({"phantom.name=sphere",
                         "phantom.radius_mm=15",
                         "render.ray_casting.edge=falling",
                         "render.volume_of_interest.size_mm=[60,60,90]",
                         "render.volume_of_interest.center_mm=[0,0,110]"});
  const Truth truth = truth_of(s);
  const render::Camera camera = render::make_camera(s.scene.render);
  const glm::dvec3 center = s.scene.phantom_placement().position_m;
  const hw::Ray ray = camera.ray(32, 32);
  const double along = glm::dot(center - ray.origin, ray.direction);
  const double off = glm::length(ray.at(along) - center);
  EXPECT_NEAR(truth.depth_m.at(32, 32), along + std::sqrt(15e-3 * 15e-3 - off * off), 0.03e-3);
}

TEST(Truth, TiltedPlaneIsWhereItsEquationSays) {
  const Stage s = stage({"phantom.name=plane", "phantom.tilt_x_deg=15", "phantom.tilt_y_deg=-10"});
  const Truth truth = truth_of(s);
  const render::Camera camera = render::make_camera(s.scene.render);
  const glm::dvec3 origin = s.scene.phantom_placement().position_m;
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

TEST(Truth, WhatNoStickReachesIsSetApart) {
  const Stage s = stage({"phantom.name=plane", "acquisition.sector_deg=20"});
  const Truth truth = truth_of(s);
  int outside = 0, seen = 0;
  const render::Camera camera = render::make_camera(s.scene.render);
  const auto geometry = s.scene.plan().geometry();
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const TruthKind kind = truth.kind.at(column, row);
      outside += kind == TruthKind::outside_field;
      if (kind != TruthKind::surface) continue;
      ++seen;
      const auto p = geometry.to_polar(
          camera.ray(column, row).at(static_cast<double>(truth.depth_m.at(column, row))));
      EXPECT_LE(std::abs(p.theta_rad), 10 * kDegree + 1e-6);
    }
  }
  EXPECT_GT(outside, 500);
  EXPECT_GT(seen, 200);
}

TEST(Truth, SpeckleBlockHasNoSurface) {
  const Truth truth = truth_of(stage({"phantom.name=speckle_block", "phantom.voxel_mm=2"}));
  for (const TruthKind kind : truth.kind.pixels) ASSERT_EQ(kind, TruthKind::none);
}

}  // namespace
}  // namespace wobblebench::bench
