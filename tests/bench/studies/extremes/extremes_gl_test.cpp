// What the study of extremes calls an error, and what it does not.
#include "bench/studies/extremes/extremes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "bench/scene/resolved_scene.h"
#include "bench/scene/scene.h"
#include "bench/studies/extremes/test_volumes.h"
#include "render/camera.h"
#include "render/renderer.h"

namespace wobblebench::bench {
namespace {

render::GlContext& gl_context() {
  static const std::unique_ptr<render::GlContext> context = render::make_context();
  context->make_current();
  return *context;
}

Scene small_scene(render::RenderPreset preset = render::RenderPreset::baseline) {
  const Scene given = load_scene({}, base_settings(), "extremes", preset);
  return resolve_scene(given, std::nullopt).options();
}

/// The passes that a change of their pictures puts beyond their bounds.
std::set<std::string> beyond(const PassPictures& pictures, const Scene& scene) {
  std::set<std::string> passes;
  for (const PassError& error : pass_errors(pictures, ball_volume(scene.plan()), scene.render)) {
    if (error.outside > 0) passes.insert(error.pass);
  }
  return passes;
}

/// The first pixel from the middle on that has a surface.
std::size_t surface_pixel(const Image<float>& depth_m) {
  std::size_t i = depth_m.pixels.size() / 2;
  while (std::isnan(depth_m.pixels.at(i))) ++i;
  return i;
}

class Passes : public ::testing::TestWithParam<render::RenderPreset> {};

TEST_P(Passes, AreThoseOfTheUntappedRenderer) {
  const Scene scene = small_scene(GetParam());
  const hw::PolarVolume volume = ball_volume(scene.plan());
  const render::Picture expected = render_volume(gl_context(), volume, scene.render);
  const PassPictures pictures = run_passes(volume, scene.render, gl_context());
  int surfaces = 0;
  for (std::size_t i = 0; i < expected.depth_m.pixels.size(); ++i) {
    EXPECT_EQ(pictures.picture.surface.pixels[i], expected.surface.pixels[i]);
    EXPECT_EQ(pictures.picture.volume.pixels[i], expected.volume.pixels[i]);
    const float z = expected.depth_m.pixels[i], filtered = expected.filtered_depth_m.pixels[i];
    EXPECT_EQ(std::isnan(pictures.depth.depth_m.pixels[i]), std::isnan(z));
    if (std::isnan(z)) continue;
    ++surfaces;
    EXPECT_EQ(pictures.depth.depth_m.pixels[i], z);
    EXPECT_EQ(pictures.depth.filtered_m.pixels[i], filtered);
  }
  EXPECT_GT(surfaces, 20);
}

/// Each fault is small: half a per cent of full scale, one step of a ray, a millimetre.
TEST_P(Passes, AFaultOfOnePixelIsBeyondTheBoundOfItsPassAlone) {
  const Scene scene = small_scene(GetParam());
  gl_context();
  const PassPictures right = run_passes(ball_volume(scene.plan()), scene.render, gl_context());
  EXPECT_EQ(beyond(right, scene), std::set<std::string>{});
  const std::size_t pixel = surface_pixel(right.depth.cast_m);
  PassPictures wrong = right;
  wrong.slices.slices[4].at(10, 10) += 0.005F;
  EXPECT_EQ(beyond(wrong, scene), std::set<std::string>{"scan conversion"});
  wrong = right;
  wrong.picture.surface.pixels[pixel].g += 0.005F;
  EXPECT_EQ(beyond(wrong, scene), std::set<std::string>{"smoothing"});
  wrong = right;
  wrong.depth.cast_m.pixels[pixel] += 5 * static_cast<float>(step_m(scene.render));
  EXPECT_TRUE(beyond(wrong, scene).contains("ray casting, z"));
  wrong.depth.cast_m.pixels[pixel] = kNoSurface;
  EXPECT_TRUE(beyond(wrong, scene).contains("ray casting, z"));
  wrong = right;
  wrong.picture.volume.pixels[pixel] += glm::vec3(0.05F);
  EXPECT_TRUE(beyond(wrong, scene).contains("ray casting, volume"));
  wrong = right;
  wrong.picture.filtered_depth_m.pixels[pixel] += 1e-3F;
  EXPECT_TRUE(beyond(wrong, scene).contains("z filter"));
  wrong = right;
  wrong.shaded.pixels[pixel] += glm::vec3(0.02F);
  EXPECT_TRUE(beyond(wrong, scene).contains("shading"));
}

INSTANTIATE_TEST_SUITE_P(Presets,
                         Passes,
                         ::testing::Values(render::RenderPreset::baseline,
                                           render::RenderPreset::accurate),
                         [](const auto& of) { return std::string(to_string(of.param)); });

TEST(Extremes, ANumberThatIsNotFiniteIsFound) {
  gl_context();
  const Scene scene = small_scene();
  const PassPictures right = run_passes(ball_volume(scene.plan()), scene.render, gl_context());
  EXPECT_TRUE(is_finite(right));
  PassPictures wrong = right;
  wrong.slices.slices[0].pixels[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_finite(wrong));
  wrong = right;
  wrong.shaded.pixels[7].b = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(is_finite(wrong));
  wrong = right;
  wrong.picture.filtered_depth_m.pixels[7] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(is_finite(wrong));
}

/// Most pixels are out of reach, and some within it change.
TEST(Extremes, ASampleChangesPixelsWithinItsReachOnly) {
  gl_context();
  const Scene scene = small_scene();
  const hw::AcquisitionPlan plan = scene.plan();
  const hw::PolarVolume volume = ball_volume(plan);
  const ChangedVolume changed = changed_volume(volume, SampleChange::one_1e30);
  const auto reached = reached_pixels(volume, changed.meant, scene.render);
  const auto count = std::count(reached.begin(), reached.end(), true);
  EXPECT_GT(count, 0);
  EXPECT_LT(count, static_cast<long>(reached.size()) / 3);
  const Image<float> before_m = run_passes(volume, scene.render, gl_context()).depth.cast_m,
                     after_m = run_passes(changed.given, scene.render, gl_context()).depth.cast_m;
  EXPECT_EQ(changed_out_of_reach(reached, before_m, after_m, scene.render), 0);
  const std::vector<bool> nothing(reached.size(), false);
  EXPECT_GT(changed_out_of_reach(nothing, before_m, after_m, scene.render), 0);
}

TEST(Extremes, WhatMustBeRefusedFailsWhereItIsRendered) {
  PhantomCache cache;
  ExtremeCase of{"rendered", {}, MustHappen::refuse};
  EXPECT_FALSE(run_extreme_case(of, render::RenderPreset::baseline, gl_context(), cache).passed());
  of = {"refused", {"acquisition.depth_mm=401"}, MustHappen::render};
  const auto outcome = run_extreme_case(of, render::RenderPreset::baseline, gl_context(), cache);
  EXPECT_FALSE(outcome.passed());
  EXPECT_EQ(outcome.refusal, "extremes: acquisition.depth_mm = 401: must be within 1 and 400");
  of.must = MustHappen::refuse;
  EXPECT_TRUE(run_extreme_case(of, render::RenderPreset::baseline, gl_context(), cache).passed());
}

TEST(Extremes, RandomCasesFollowFromTheirSeed) {
  const auto one = random_extreme_cases(7, 5), same = random_extreme_cases(7, 5),
             other = random_extreme_cases(8, 5);
  ASSERT_EQ(one.size(), 5U);
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].settings, same[i].settings);
    EXPECT_NE(one[i].settings, other[i].settings);
    EXPECT_GT(one[i].settings.size(), 5U);
  }
}

TEST(Extremes, NumbersAreExactAtTheirEnds) {
  for (const NumberOutcome& number : run_number_cases()) {
    EXPECT_LE(number.worst, number.bound) << number.name;
  }
}

}  // namespace
}  // namespace wobblebench::bench
