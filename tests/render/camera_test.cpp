#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <random>

namespace wobblebench::render {
namespace {

RenderOptions random_view(std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-kPi, kPi), side(0.01, 0.2), center(-0.1, 0.1);
  RenderOptions options;
  options.view = {angle(random), angle(random), angle(random)};
  options.view.projection = random() % 2 == 0 ? Projection::parallel : Projection::perspective;
  options.volume_of_interest.center_m = {center(random), center(random), center(random)};
  options.volume_of_interest.size_m = {side(random), side(random), side(random)};
  options.ray_casting.image_size = 1 + static_cast<int>(random() % 512);
  return options;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  EXPECT_LE(glm::distance(a, b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Camera, AtRestFacesZWithXRightAndYDown) {
  RenderOptions options;
  options.ray_casting.image_size = 100;
  const Camera camera = make_camera(options);
  const hw::Ray first = camera.ray(0, 0), last = camera.ray(99, 99);
  expect_near(first.direction, {0, 0, 1}, 1e-15);
  EXPECT_NEAR(first.origin.x, -0.05 + 0.0005, 1e-15);
  EXPECT_NEAR(first.origin.y, -0.05 + 0.0005, 1e-15);
  EXPECT_NEAR(last.origin.x, 0.05 - 0.0005, 1e-15);
  EXPECT_NEAR(last.origin.y, 0.05 - 0.0005, 1e-15);
}

TEST(Camera, IsAsWideAsTheLongerSideOfTheBoxAcross) {
  RenderOptions options;
  options.volume_of_interest.size_m = {0.03, 0.07, 0.2};
  EXPECT_DOUBLE_EQ(make_camera(options).width_m, 0.07);
  options.volume_of_interest.size_m = {0.08, 0.07, 0.2};
  EXPECT_DOUBLE_EQ(make_camera(options).width_m, 0.08);
}

TEST(Camera, PositiveYawMovesTheEyeRightAndPositivePitchMovesItUp) {
  RenderOptions options;
  options.view.yaw_rad = 30 * kDegree;
  EXPECT_GT((-make_camera(options).forward).x, 0.49);
  options.view = {0, 30 * kDegree, 0};
  EXPECT_LT((-make_camera(options).forward).y, -0.49);  // y points down
  options.view = {0, 0, 90 * kDegree};
  expect_near(make_camera(options).right, {0, 1, 0}, 1e-15);
}

TEST(Camera, AxesStayOrthonormalAndRightHanded) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Camera camera = make_camera(random_view(random));
    expect_near(glm::cross(camera.right, camera.down), camera.forward, 1e-14);
    expect_near(glm::cross(camera.down, camera.forward), camera.right, 1e-14);
    EXPECT_NEAR(glm::length(camera.forward), 1, 1e-14);
  }
}

/// [right down forward] = Ry(-yaw) Rx(-pitch) Rz(roll), by right-handed rotations.
TEST(Camera, AxesAreThoseOfYawThenPitchThenRoll) {
  std::mt19937 random(6);
  for (int i = 0; i < 100; ++i) {
    const RenderOptions options = random_view(random);
    const double a = -options.view.yaw_rad, b = -options.view.pitch_rad, g = options.view.roll_rad;
    using std::cos, std::sin;
    const glm::dmat3 about_y{{cos(a), 0, -sin(a)}, {0, 1, 0}, {sin(a), 0, cos(a)}};
    const glm::dmat3 about_x{{1, 0, 0}, {0, cos(b), sin(b)}, {0, -sin(b), cos(b)}};
    const glm::dmat3 about_z{{cos(g), sin(g), 0}, {-sin(g), cos(g), 0}, {0, 0, 1}};
    const glm::dmat3 axes = about_y * about_x * about_z;
    const Camera camera = make_camera(options);
    expect_near(camera.right, axes[0], 1e-14);
    expect_near(camera.down, axes[1], 1e-14);
    expect_near(camera.forward, axes[2], 1e-14);
  }
}

TEST(Camera, AFlippedPictureShowsInEachColumnWhatTheOneOppositeShowed) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    RenderOptions options = random_view(random);
    const Camera camera = make_camera(options);
    options.view.flip = true;
    const Camera flipped = make_camera(options);
    const int last = camera.image_size - 1, column = static_cast<int>(random() % 512) % (last + 1);
    const hw::Ray ray = camera.ray(column, 3), mirrored = flipped.ray(last - column, 3);
    expect_near(mirrored.origin, ray.origin, 1e-15);
    expect_near(mirrored.direction, ray.direction, 1e-15);
    const PicturePoint point = flipped.project(mirrored.at(0.1));
    EXPECT_NEAR(point.column, last - column, 1e-9 * camera.image_size);
  }
}

TEST(Camera, ProjectionInvertsRays) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> share(-0.5, 1.5), depth(0.01, 0.5);
  for (int i = 0; i < 1000; ++i) {
    const Camera camera = make_camera(random_view(random));
    const double column = share(random) * camera.image_size,
                 row = share(random) * camera.image_size;
    const double depth_m = depth(random);
    const PicturePoint point = camera.project(camera.ray(column, row).at(depth_m));
    EXPECT_NEAR(point.column, column, 1e-9 * camera.image_size);
    EXPECT_NEAR(point.row, row, 1e-9 * camera.image_size);
    EXPECT_NEAR(point.depth_m, depth_m, 1e-12);
  }
}

TEST(Camera, ParallelViewPlaneLeavesTheWholeBoxBehindIt) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    RenderOptions options = random_view(random);
    options.view.projection = Projection::parallel;
    const Camera camera = make_camera(options);
    const auto& c = options.volume_of_interest.center_m;
    const auto& s = options.volume_of_interest.size_m;
    for (int corner = 0; corner < 8; ++corner) {
      glm::dvec3 position;
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] = c[axis] + ((corner >> axis & 1) - 0.5) * s[axis];
      }
      EXPECT_GE(camera.project(position).depth_m, -1e-12);
    }
  }
}

TEST(ClipToBox, HoldsExactlyThePointsOfTheRayInTheBox) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> share(0, 1), along(-0.2, 0.6);
  int rays_that_hit = 0;
  for (int i = 0; i < 2000; ++i) {
    const RenderOptions options = random_view(random);
    const VolumeOfInterest& box = options.volume_of_interest;
    const Camera camera = make_camera(options);
    const hw::Ray ray =
        camera.ray(share(random) * camera.image_size, share(random) * camera.image_size);
    const Span span = clip_to_box(ray, box);
    rays_that_hit += span.to_m >= span.from_m;
    const double t = along(random);
    const glm::dvec3 position = ray.at(t);
    double beyond_m = -1;  // largest distance beyond a face
    for (int axis = 0; axis < 3; ++axis) {
      beyond_m =
          std::max(beyond_m, std::abs(position[axis] - box.center_m[axis]) - box.size_m[axis] / 2);
    }
    if (std::abs(beyond_m) < 1e-12) continue;
    EXPECT_EQ(t >= std::max(span.from_m, 0.0) && t <= span.to_m, beyond_m < 0 && t >= 0);
  }
  EXPECT_GT(rays_that_hit, 500);
}

TEST(ClipToBox, StartsAtTheOriginOfARayThatBeginsInside) {
  const Span span = clip_to_box({{0, 0, 0.12}, {0, 0, 1}}, VolumeOfInterest{});
  EXPECT_EQ(span.from_m, 0);
  EXPECT_NEAR(span.to_m, 0.04, 1e-15);
}

TEST(ClipToBox, IsEmptyBesideTheBoxAndBehindTheOrigin) {
  const VolumeOfInterest box;
  for (const hw::Ray& ray : {hw::Ray{{0.051, 0, 0}, {0, 0, 1}},
                             hw::Ray{{0, 0, 0.2}, {0, 0, 1}},
                             hw::Ray{{0, -0.06, 0.12}, {1, 0, 0}}}) {
    const Span span = clip_to_box(ray, box);
    EXPECT_LT(span.to_m, span.from_m);
  }
}

TEST(Step, IsTheDepthOfTheBoxOverTheSteps) {
  RenderOptions options;
  options.volume_of_interest.size_m = {1, 1, 0.064};
  options.ray_casting.steps = 64;
  EXPECT_DOUBLE_EQ(step_m(options), 1e-3);
}

}  // namespace
}  // namespace wobblebench::render
