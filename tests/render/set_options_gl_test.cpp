// Settings of a living renderer: its pictures are those of a new one in a new context.
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <random>

#include "render/gl/program.h"
#include "render/renderer.h"
#include "tests/render/support/agreement.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

using testing::expect_same_bits;
using testing::gl_context;

/// No program and no texture of the tests' other pictures.
Picture in_a_new_context(const RenderOptions& options) {
  const std::string backend = gl_context().backend();
  Picture picture;
  {
    const auto context = make_context(backend);
    picture = render_volume(*context, testing::noisy_scene(), options);
  }
  gl_context().make_current();
  return picture;
}

class RandomSettings {
 public:
  explicit RandomSettings(unsigned seed) : random_(seed) {}

  /// Other settings of passes 3 and 4.
  RenderOptions shaded(RenderOptions o) {
    ShadingOptions& s = o.shading;
    s.depth_filter_size = pick({1, 5});
    s.light = pick({Light::point, Light::directional});
    s.light_left_rad = real(-80, 80) * kDegree;
    s.light_up_rad = real(-80, 80) * kDegree;
    s.light_distance_m = real(0.05, 0.5);
    s.ambient = real(0, 0.3);
    s.base = pick({ShadingBase::constant, ShadingBase::rendered});
    s.shadows = pick({true, true, false});
    s.shadow_bias_m = real(0, 2e-3);
    o.smoothing.filter = pick({SmoothingFilter::box, SmoothingFilter::guided});
    o.smoothing.filter_size = pick({1, 5});
    return o;
  }

  /// Other settings of passes 2 to 4.
  RenderOptions changed(RenderOptions o) {
    o.view.yaw_rad = real(-40, 40) * kDegree;
    o.view.flip = pick({true, false});
    o.view.projection = pick({Projection::parallel, Projection::perspective});
    RayCastingOptions& r = o.ray_casting;
    r.mode = pick({RenderMode::surface, RenderMode::volume, RenderMode::both});
    r.image_size = pick({24, 40});
    r.steps = pick({64, 150});
    if (r.detector != Detector::paper) r.detector = pick({Detector::iso, Detector::floor});
    r.iso_level = real(0.3, 0.8);
    r.incidence_correction_m =
        pick({std::optional<double>(0.0), std::optional<double>(0.5e-3), std::optional<double>()});
    r.buffer_length = pick({4, 8, 12});
    r.threshold = real(0.1, 0.9);
    r.refine_crossing = pick({true, false});
    r.stop_on_leaving_cone = pick({true, false});
    r.opacity_limit = real(0.3, 1.1);
    r.transfer_values[1] = real(0.1, 0.4);
    o.shading.depth_filter_size = pick({1, 5});
    o.shading.light = pick({Light::point, Light::directional});
    o.shading.ambient = real(0, 0.3);
    o.shading.shadows = pick({true, false});
    o.smoothing.filter =
        pick({SmoothingFilter::box, SmoothingFilter::bilateral, SmoothingFilter::guided});
    o.smoothing.filter_size = pick({1, 3, 5});
    return o;
  }

 private:
  double real(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  template <class T>
  T pick(std::initializer_list<T> values) {
    return *(values.begin() + random_() % values.size());
  }

  std::mt19937 random_;
};

struct Slices {
  const char* name;
  PipelineMode mode;
  Detector detector;
  Sticks sticks;
};
class SetOptions : public ::testing::TestWithParam<Slices> {};

RenderOptions options_of(const Slices& slices) {
  RenderOptions options = testing::small_options();
  options.pipeline.mode = slices.mode;
  options.ray_casting.detector = slices.detector;
  options.reconstruction.sticks = slices.sticks;
  return options;
}

TEST_P(SetOptions, GivesThePictureOfANewRenderer) {
  const RenderOptions first = options_of(GetParam());
  RandomSettings random(7);
  Renderer renderer(gl_context(), testing::noisy_scene().plan(), first);
  renderer.add_volume(testing::noisy_scene());
  renderer.render();
  for (int i = 0; i < 4; ++i) {
    const RenderOptions options = random.changed(first);
    ASSERT_TRUE(renderer.keeps_slices(options));
    renderer.set_options(options);
    expect_same_bits(renderer.render(), in_a_new_context(options));
  }
}

TEST_P(SetOptions, HoldsForVolumesThatFollow) {
  const RenderOptions first = options_of(GetParam());
  const hw::PolarVolume& scene = testing::noisy_scene();
  const hw::PolarVolume blank =
      testing::sample_field(testing::small_plan(), [](const glm::dvec3&) { return 0.0; });
  const RenderOptions options = RandomSettings(3).changed(first);
  Renderer renderer(gl_context(), scene.plan(), first);
  renderer.add_volume(blank);
  renderer.render();
  for (int frame = 0; frame < 10; ++frame) renderer.add_frame(frame, scene.frame(frame));
  renderer.set_options(options);
  EXPECT_EQ(testing::hits(renderer.render().depth_m),
            0);  // of the blank volume, the last whole one
  for (int frame = 10; frame < 21; ++frame) renderer.add_frame(frame, scene.frame(frame));
  expect_same_bits(renderer.render(), in_a_new_context(options));
}

bool has_cast(const Picture& picture) {
  return std::ranges::any_of(picture.passes,
                             [](const PassTime& pass) { return pass.name == "ray_casting"; });
}

TEST_P(SetOptions, KeepsRaysWhereShadingAloneHasChanged) {
  for (const Projection projection : {Projection::parallel, Projection::perspective}) {
    RenderOptions first = options_of(GetParam());
    first.view.projection = projection;
    first.ray_casting.mode = RenderMode::both;
    first.ray_casting.incidence_correction_m = 0.5e-3;
    RandomSettings random(11);
    Renderer renderer(gl_context(), testing::noisy_scene().plan(), first);
    renderer.add_volume(testing::noisy_scene());
    EXPECT_TRUE(has_cast(renderer.render(Rays::keep)));
    RenderOptions options = first;
    for (int i = 0; i < 6; ++i) {
      // Every third changes numbers of the shaders alone.
      if (i % 3 > 0) options = random.shaded(first);
      options.shading.light_left_rad += 0.1;
      renderer.set_options(options);
      const Picture picture = renderer.render(Rays::keep);
      EXPECT_FALSE(has_cast(picture));
      expect_same_bits(picture, in_a_new_context(options));
    }
  }
}

TEST_P(SetOptions, CastsRaysWhereMoreHasChanged) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  RenderOptions options = options_of(GetParam());
  Renderer renderer(gl_context(), scene.plan(), options);
  renderer.add_volume(scene);
  renderer.render(Rays::keep);
  const auto expect_cast = [&](bool expected) {
    renderer.set_options(options);
    const Picture picture = renderer.render(Rays::keep);
    EXPECT_EQ(has_cast(picture), expected);
    expect_same_bits(picture, in_a_new_context(options));
  };
  expect_cast(false);
  options.view.yaw_rad = 0.3;
  expect_cast(true);
  options.ray_casting.steps = 100;
  expect_cast(true);
  renderer.add_frame(0, scene.frame(0));
  options.shading.ambient = 0.2;
  expect_cast(false);
  for (int frame = 1; frame < scene.plan().acquisition().frames_per_volume; ++frame) {
    renderer.add_frame(frame, scene.frame(frame));
  }
  expect_cast(true);
  RenderTaps nearer;
  nearer.depth = [](const CastDepth& depth) { return std::optional(depth.filtered_m); };
  renderer.set_taps(nearer);
  EXPECT_TRUE(has_cast(renderer.render(Rays::keep)));
  EXPECT_TRUE(has_cast(renderer.render(Rays::keep)));
  renderer.set_taps({});
  expect_cast(true);
  renderer.compile();
  expect_cast(true);
}

TEST(SetOptions, EachFrameIsCastInPicturesOfTwoVolumes) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  RenderOptions options = testing::small_options();
  options.pipeline.mid_volume = true;
  Renderer renderer(gl_context(), scene.plan(), options);
  renderer.add_volume(scene);
  renderer.render();
  renderer.add_frame(3, scene.frame(4));
  const Picture kept = renderer.render(Rays::keep);
  EXPECT_TRUE(has_cast(kept));
  expect_same_bits(kept, renderer.render());
}

INSTANTIATE_TEST_SUITE_P(
    Pipelines,
    SetOptions,
    ::testing::Values(Slices{"fast_paper", PipelineMode::fast, Detector::paper, Sticks::plain},
                      Slices{"fast_iso", PipelineMode::fast, Detector::iso, Sticks::plain},
                      Slices{"fast_aligned", PipelineMode::fast, Detector::floor, Sticks::aligned},
                      Slices{"plain_iso", PipelineMode::plain, Detector::iso, Sticks::plain}),
    [](const auto& param_info) { return param_info.param.name; });

TEST(SetOptions, RefusesWhatPassOneWouldMakeAnew) {
  const RenderOptions first = testing::small_options();
  Renderer renderer(gl_context(), testing::noisy_scene().plan(), first);
  renderer.add_volume(testing::noisy_scene());
  const Picture before = renderer.render();
  const auto refused = [&](const auto& change) {
    RenderOptions options = first;
    change(options);
    EXPECT_FALSE(renderer.keeps_slices(options));
    EXPECT_THROW(renderer.set_options(options), std::invalid_argument);
  };
  refused([](RenderOptions& o) { o.pipeline.mode = PipelineMode::plain; });
  refused([](RenderOptions& o) { o.reconstruction.sticks = Sticks::aligned; });
  refused([](RenderOptions& o) { o.scan_conversion.slice_size *= 2; });
  refused([](RenderOptions& o) { o.scan_conversion.filter_size = 5; });
  refused([](RenderOptions& o) { o.scan_conversion.format = TextureFormat::r8; });
  refused([](RenderOptions& o) { o.volume_of_interest.center_m.x += 1e-3; });
  refused([](RenderOptions& o) { o.ray_casting.kernel_3d = 5; });
  refused([](RenderOptions& o) { o.ray_casting.kernel_space = KernelSpace::ray; });
  refused([](RenderOptions& o) { o.ray_casting.window_2d = 3; });
  refused([](RenderOptions& o) { o.ray_casting.stop_at_box = false; });
  refused([](RenderOptions& o) { o.ray_casting.detector = Detector::iso; });
  expect_same_bits(renderer.render(), before);
  RenderOptions bad = first;
  bad.ray_casting.kernel_3d = 2;
  EXPECT_THROW(renderer.set_options(bad), InvalidOption);
  expect_same_bits(renderer.render(), before);
}

/// More programs than a pool keeps; what is taken once is not given again.
TEST(ProgramPool, GivesEachProgramOnce) {
  gl_context().make_current();
  const auto make = [&](int i) {
    return FragmentProgram({"smooth.frag.glsl"},
                           Defines()
                               .add("NUMBER", i)
                               .add("BIND_PICTURE", 0)
                               .add("BIND_SOURCE", 1)
                               .add("HALF_FILTER", 1)
                               .add("BILATERAL", 0));
  };
  const Texture texture("target", TexelFormat::rgba32f, {2, 2}, TextureFilter::nearest);
  const Framebuffer target({&texture});
  for (int i = 0; i < 150; ++i) make(i);
  FragmentProgram one = make(149), other = make(149);
  one = std::move(other);
  EXPECT_NO_THROW(one.draw(target, {{0, &texture}}));
  EXPECT_NO_THROW(make(0).draw(target, {{0, &texture}}));
  check_gl("programs of the pool");
}

/// Difference sums n / 2 differences: twice the buffer has twice the threshold on the sum, and the
/// same one on the mean.
TEST(SetOptions, AThresholdPerSampleIsTimesHalfOfTheBuffer) {
  for (const int n : {4, 8, 16}) {
    RenderOptions summed = testing::small_options();
    summed.ray_casting.detector = Detector::paper;
    summed.ray_casting.buffer_length = n;
    summed.ray_casting.threshold = 0.0625 * n / 2;
    RenderOptions mean = summed;
    mean.ray_casting.threshold = RayCastingOptions{}.threshold;
    mean.ray_casting.threshold_per_sample = 0.0625;
    expect_same_bits(render_volume(gl_context(), testing::noisy_scene(), mean),
                     render_volume(gl_context(), testing::noisy_scene(), summed));
  }
}

}  // namespace
}  // namespace wobblebench::render
