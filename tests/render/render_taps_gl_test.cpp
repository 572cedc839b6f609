// What the taps of the renderer see, and what a replaced z becomes.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "render/reference/reference.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;
using testing::hits;
using testing::same_bits;

class Taps : public ::testing::TestWithParam<PipelineMode> {
 protected:
  Taps() {
    options_.pipeline.mode = GetParam();
    options_.ray_casting.incidence_correction_m = 1e-3;
  }
  RenderOptions options_ = testing::small_options();
};

/// A tap that moves z away from the viewer.
RenderTaps moving(float by_m) {
  RenderTaps taps;
  taps.depth = [by_m](const CastDepth& depth) {
    Image<float> moved_m = depth.depth_m;
    for (float& z : moved_m.pixels) z += by_m;
    return moved_m;
  };
  return taps;
}

TEST_P(Taps, SeeEachStageAndChangeNothing) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  const Picture expected = render_volume(gl_context(), scene, options_);
  Renderer renderer(gl_context(), scene.plan(), options_);
  VolumeSlices slices;
  CastDepth depth;
  Image<glm::vec3> shaded, smoothed;
  RenderTaps taps;
  taps.slices = [&](const VolumeSlices& made) { slices = made; };
  taps.depth = [&](const CastDepth& cast) {
    depth = cast;
    return std::nullopt;
  };
  taps.shaded = [&](const Image<glm::vec3>& picture) { shaded = picture; };
  taps.smoothed = [&](const Image<glm::vec3>& picture) { smoothed = picture; };
  renderer.set_taps(taps);
  renderer.add_volume(scene);
  const Picture picture = renderer.render();
  EXPECT_TRUE(same_bits(picture.depth_m, expected.depth_m));
  EXPECT_EQ(picture.surface.pixels, expected.surface.pixels);
  EXPECT_EQ(picture.passes.size(), 4u);

  EXPECT_EQ(slices.slices.size(), scene.frames().size());
  EXPECT_EQ(slices.slices.back().width, slices.pixels.columns);
  EXPECT_EQ(slices.slices.back().height, slices.pixels.rows);
  EXPECT_TRUE(same_bits(depth.depth_m, expected.depth_m));
  EXPECT_FALSE(same_bits(depth.cast_m, depth.depth_m)) << "before the correction for incidence";
  EXPECT_EQ(hits(depth.cast_m), hits(depth.depth_m));
  EXPECT_TRUE(same_bits(depth.filtered_m, expected.filtered_depth_m));
  EXPECT_EQ(smoothed.pixels, expected.surface.pixels);
  EXPECT_NE(shaded.pixels, smoothed.pixels);
}

TEST_P(Taps, PassesGoOnWithAReplacedDepth) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  Renderer renderer(gl_context(), scene.plan(), options_);
  renderer.add_volume(scene);
  const Picture before = renderer.render();
  renderer.set_taps(moving(2e-3f));
  const Picture moved = renderer.render();
  const Picture expected = shade_depth(moved.depth_m, options_, moved.volume);
  int beyond = 0;
  for (std::size_t i = 0; i < moved.depth_m.pixels.size(); ++i) {
    const glm::vec3 off = moved.surface.pixels[i] - expected.surface.pixels[i];
    for (int c = 0; c < 3; ++c) beyond += std::abs(off[c]) > 2e-3f;
    const float z = before.depth_m.pixels[i];
    EXPECT_EQ(std::isnan(moved.depth_m.pixels[i]), std::isnan(z));
    if (std::isnan(z)) continue;
    EXPECT_EQ(moved.depth_m.pixels[i], z + 2e-3f);
    EXPECT_NEAR(moved.filtered_depth_m.pixels[i], expected.filtered_depth_m.pixels[i], 1e-7);
  }
  // The rest are pixels on the border of a shadow, where float rounding decides.
  EXPECT_LE(beyond, 0.002 * 3 * double(moved.depth_m.pixels.size()));

  ASSERT_EQ(moved.passes.size(), 5u);
  EXPECT_EQ(moved.passes[1].name, "ray_casting");
  EXPECT_EQ(moved.passes[2].name, "correction");
  EXPECT_GT(moved.passes[2].ms, 0);
  EXPECT_EQ(moved.passes[3].name, "surface_shading");

  renderer.set_taps({});
  const Picture again = renderer.render();
  EXPECT_TRUE(same_bits(again.depth_m, before.depth_m));
  EXPECT_EQ(again.surface.pixels, before.surface.pixels);
}

TEST_P(Taps, AReplacedDepthFollowsTheSizeOfThePicture) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  Renderer renderer(gl_context(), scene.plan(), options_);
  renderer.set_taps(moving(1e-3f));
  renderer.add_volume(scene);
  static_cast<void>(renderer.render());
  options_.ray_casting.image_size /= 2;
  renderer.set_options(options_);
  const Picture smaller = renderer.render();
  EXPECT_EQ(smaller.depth_m.width, options_.ray_casting.image_size);
  EXPECT_EQ(smaller.passes.size(), 5u);
  EXPECT_GT(hits(smaller.depth_m), 0);
}

TEST_P(Taps, WhatATapThrowsLeavesAndTheRendererGoesOn) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  Renderer renderer(gl_context(), scene.plan(), options_);
  renderer.add_volume(scene);
  const Picture expected = renderer.render();
  RenderTaps taps;
  taps.depth = [](const CastDepth&) { return Image<float>(3, 3, 0.1f); };
  renderer.set_taps(taps);
  EXPECT_THROW(static_cast<void>(renderer.render()), std::invalid_argument);
  taps.depth = [](const CastDepth&) -> std::optional<Image<float>> {
    throw std::runtime_error("no correction");
  };
  renderer.set_taps(taps);
  EXPECT_THROW(static_cast<void>(renderer.render()), std::runtime_error);
  renderer.set_taps({});
  EXPECT_EQ(renderer.render().surface.pixels, expected.surface.pixels);
}

INSTANTIATE_TEST_SUITE_P(Modes,
                         Taps,
                         ::testing::Values(PipelineMode::fast, PipelineMode::plain),
                         [](const auto& of) {
                           return of.param == PipelineMode::fast ? "fast" : "plain";
                         });

}  // namespace
}  // namespace wobblebench::render
