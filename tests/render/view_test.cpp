#include "render/view.h"

#include <gtest/gtest.h>

namespace wobblebench::render {
namespace {

TEST(View, HasTheCameraBoxAndEdgeOfItsOptions) {
  RenderOptions options;
  options.view.yaw_rad = 30 * kDegree;
  options.volume_of_interest.size_m = {0.05, 0.06, 0.07};
  options.ray_casting.edge = EdgeSign::falling;
  const View view = make_view(options);
  const Camera camera = make_camera(options);
  EXPECT_EQ(view.camera.forward, camera.forward);
  EXPECT_EQ(view.camera.image_size, options.ray_casting.image_size);
  EXPECT_EQ(view.box.center_m, options.volume_of_interest.center_m);
  EXPECT_EQ(view.box.size_m, glm::dvec3(0.05, 0.06, 0.07));
  EXPECT_EQ(view.edge, EdgeSign::falling);
}

}  // namespace
}  // namespace wobblebench::render
