#include "render/geometry/lighting.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace wobblebench::render {
namespace {

TEST(Lighting, ZeroAnglesPointToTheViewer) {
  ShadingOptions options;
  options.light_up_rad = 0;
  EXPECT_EQ(light_direction(options), glm::dvec3(0, 0, -1));
}

TEST(Lighting, PositiveAnglesAreLeftAndUp) {
  ShadingOptions options;
  options.light_left_rad = 40 * kDegree;
  options.light_up_rad = 25 * kDegree;
  const glm::dvec3 direction = light_direction(options);
  EXPECT_NEAR(direction.x, -std::sin(40 * kDegree) * std::cos(25 * kDegree), 1e-15);
  EXPECT_NEAR(direction.y, -std::sin(25 * kDegree), 1e-15);
  EXPECT_LT(direction.z, 0);
  EXPECT_NEAR(glm::length(direction), 1, 1e-15);
}

TEST(Lighting, TheLightTurnsWithTheViewer) {
  for (Projection projection : {Projection::parallel, Projection::perspective}) {
    RenderOptions options;
    options.view = {0.4, -0.7, 0.2, projection};
    options.shading.light_left_rad = 0.3;
    const Camera camera = make_camera(options);
    const glm::dvec3 in_probe = light_position_in_probe_m(options.shading, camera);
    EXPECT_NEAR(glm::distance(in_probe, camera.center), options.shading.light_distance_m, 1e-15);
    const glm::dvec3 in_view = light_position_m(options.shading, camera);
    const glm::dvec3 origin = projection == Projection::parallel
                                  ? camera.center - camera.plane_distance_m * camera.forward
                                  : camera.center - camera.eye_distance_m * camera.forward;
    const glm::dvec3 rebuilt =
        origin + in_view.x * camera.right + in_view.y * camera.down + in_view.z * camera.forward;
    EXPECT_LT(glm::distance(rebuilt, in_probe), 1e-15);
  }
}

}  // namespace
}  // namespace wobblebench::render
