// A correction on the renderer's own path, against passes 3 and 4 of the reference.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/evaluation/error_model/correction.h"
#include "bench/scene/resolved_scene.h"
#include "bench/studies/extremes/test_volumes.h"
#include "render/camera.h"
#include "render/reference/reference.h"

namespace wobblebench::bench {
namespace {

TEST(CorrectedPicture, IsShadedAndSmoothedFromCorrectedZ) {
  Scene scene = load_scene({}, {"render.ray_casting.image_size=48"});
  scene = resolve_scene(scene, std::nullopt).options();
  const hw::PolarVolume volume = ball_volume(scene.plan());
  Correction correction{
      {}, correction_conditions(scene), render::step_m(scene.render) / kMillimetre};
  correction.model.bias[kConstantTerm] = {-1, -1, -1, true};

  const auto context = render::make_context();
  render::Renderer renderer(*context, scene.plan(), scene.render);
  renderer.add_volume(volume);
  const render::Picture plain = renderer.render();
  const render::Picture corrected = corrected_picture(correction, renderer, plain, volume, scene);
  const render::Picture expected =
      render::shade_depth(corrected.depth_m, scene.render, corrected.volume);

  int surfaces = 0, beyond = 0;
  for (std::size_t i = 0; i < plain.depth_m.pixels.size(); ++i) {
    const float z = plain.depth_m.pixels[i], moved = corrected.depth_m.pixels[i];
    EXPECT_EQ(std::isnan(moved), std::isnan(z));
    const glm::vec3 off = corrected.surface.pixels[i] - expected.surface.pixels[i];
    for (int c = 0; c < 3; ++c) beyond += std::abs(off[c]) > 2e-3f;
    if (std::isnan(z)) continue;
    ++surfaces;
    EXPECT_NEAR(moved - z, 1e-3, 1e-7);
    EXPECT_NEAR(corrected.filtered_depth_m.pixels[i], expected.filtered_depth_m.pixels[i], 1e-7);
  }
  EXPECT_GT(surfaces, 100);
  EXPECT_LE(beyond, 0.002 * 3 * 48 * 48);  // on the border of a shadow

  ASSERT_EQ(corrected.passes.size(), 5U);
  EXPECT_EQ(corrected.passes[0].ms, plain.passes[0].ms);
  EXPECT_EQ(corrected.passes[2].name, "correction");
  EXPECT_GT(corrected.passes[2].ms, 0);
  EXPECT_EQ(renderer.render().surface.pixels, plain.surface.pixels) << "the tap is gone";
}

}  // namespace
}  // namespace wobblebench::bench
