// Warnings of what a picture shows, for pictures made by hand.
#include "bench/cli/picture/picture_warnings.h"

#include <gtest/gtest.h>

#include "bench/scene/scene.h"
#include "phantoms/phantom.h"
#include "tests/support/expect.h"

namespace wobblebench::bench {
namespace {

constexpr double kFace_mm = 50;  ///< z of the face on the probe's axis

/// Its box is 10 mm wide, on the probe's axis, and begins at the face.
ResolvedScene scene_at_the_face() {
  const Scene scene = load_scene({},
                                 {"phantom.name=sphere",
                                  "probe.radius_mm=50",
                                  "phantom.voxel_mm=2",
                                  "render.ray_casting.image_size=64",
                                  "render.volume_of_interest.center_mm=[0, 0, 65]",
                                  "render.volume_of_interest.size_mm=[10, 10, 30]"});
  return resolve_scene(scene, phantoms::make_phantom(scene.phantom));
}

/// Of a plane across the axis, `range_mm` before the face.
render::Picture picture_of_plane(const ResolvedScene& scene, double range_mm) {
  const render::Camera& camera = scene.view().camera;
  render::Picture picture;
  picture.depth_m = Image<float>(camera.image_size, camera.image_size);
  const double depth_m = 1e-3 * (kFace_mm + range_mm) - camera.ray(0, 0).origin.z;
  picture.depth_m.pixels.assign(picture.depth_m.pixels.size(), static_cast<float>(depth_m));
  return picture;
}

TEST(PictureWarnings, SayThatTheNearFieldIsShown) {
  const ResolvedScene scene = scene_at_the_face();
  const auto warnings = picture_warnings(picture_of_plane(scene, 2), scene, nullptr);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings.front().find("100 % of the surface in the picture lies within 5 mm"), 0U)
      << warnings.front();
  EXPECT_TRUE(picture_warnings(picture_of_plane(scene, 8), scene, nullptr).empty());
}

TEST(PictureWarnings, SayThatAnotherSurfaceHidesTheTrueOne) {
  const ResolvedScene scene = scene_at_the_face();
  const render::Picture picture = picture_of_plane(scene, 20);
  DepthError error;
  error.surface = error.pixels = 4096;
  error.depth.median_m = -6e-3;
  const auto warnings = picture_warnings(picture, scene, &error);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_TRUE(holds(warnings.front(), "in front of the true one, nearer by a median of 6 mm"));
  error.depth.median_m = 6e-3;
  EXPECT_TRUE(picture_warnings(picture, scene, &error).empty());
}

}  // namespace
}  // namespace wobblebench::bench
