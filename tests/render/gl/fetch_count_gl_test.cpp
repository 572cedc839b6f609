#include <gtest/gtest.h>

#include <stdexcept>

#include "render/gl/fetch_count.h"
#include "render/gl/program.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;
using Sampler = TextureFetch::Sampler;

const PassTime& pass_of(const Picture& picture, const std::string& name) {
  for (const PassTime& pass : picture.passes) {
    if (pass.name == name) return pass;
  }
  throw std::out_of_range(name);
}

class FetchCountOfSampler : public ::testing::TestWithParam<Sampler> {};

TEST_P(FetchCountOfSampler, EqualsPixelsTimesTaps) {
  gl_context();
  FetchCounter counter;
  const bool is_plane = GetParam() == Sampler::plane;
  const Texture fetched("fetched",
                        TexelFormat::rg16,
                        {4, 4, is_plane ? 0 : 3, GetParam() == Sampler::layers},
                        TextureFilter::linear);
  const Texture sums("sums", TexelFormat::r32f, {8, 6}, TextureFilter::nearest);
  const Framebuffer target({&sums});
  const FragmentProgram program({"fetch_rate.frag.glsl"}, fetch_rate_defines(GetParam(), 5, 8));
  program.draw(target, {{0, &fetched}});
  const FetchCounts expected = {
      {{GetParam(), TexelFormat::rg16, TextureFilter::linear}, 8 * 6 * 5}};
  EXPECT_EQ(counter.take(), expected);
  EXPECT_TRUE(counter.take().empty());
}

INSTANTIATE_TEST_SUITE_P(Samplers,
                         FetchCountOfSampler,
                         ::testing::Values(Sampler::plane, Sampler::volume, Sampler::layers));

/// Settings with which every ray runs to the far side of the box.
RenderOptions endless_rays() {
  RenderOptions options = testing::small_options();
  options.pipeline.mode = PipelineMode::plain;
  options.ray_casting.mode = RenderMode::surface;
  options.ray_casting.kernel_3d = 1;
  options.ray_casting.threshold = 64;
  options.ray_casting.stop_on_leaving_cone = false;
  return options;
}

TEST(FetchCount, InModePlainIncludesOneMotionTableFetchPerStep) {
  const RenderOptions options = endless_rays();
  GlContext& context = gl_context();
  const FetchCounter counter;
  const Picture picture = render_volume(context, testing::noisy_scene(), options);
  const FetchCounts& fetches = pass_of(picture, "ray_casting").fetches;
  const std::int64_t size = options.ray_casting.image_size;
  const TextureFetch motion_table = {Sampler::plane, TexelFormat::rgb32f, TextureFilter::linear};
  EXPECT_EQ(fetches.at(motion_table), size * size * options.ray_casting.steps);
  // Slices are read only inside the cone.
  const TextureFetch slices = {Sampler::volume, TexelFormat::r16, TextureFilter::linear};
  EXPECT_LT(fetches.at(slices), fetches.at(motion_table));
  EXPECT_GT(fetches.at(slices), 0);
}

TEST(FetchCount, DoesNotChangeThePicture) {
  for (const auto& [mode, projection] : {std::pair(PipelineMode::plain, Projection::parallel),
                                         {PipelineMode::fast, Projection::parallel},
                                         {PipelineMode::fast, Projection::perspective}}) {
    RenderOptions options = testing::small_options();
    options.pipeline.mode = mode;
    options.view.projection = projection;
    const hw::PolarVolume volume = testing::noisy_scene();
    const Picture alone = render_volume(gl_context(), volume, options);
    for (const PassTime& pass : alone.passes) EXPECT_TRUE(pass.fetches.empty()) << pass.name;
    const FetchCounter counter;
    const Picture counted = render_volume(gl_context(), volume, options);
    for (const PassTime& pass : counted.passes) EXPECT_FALSE(pass.fetches.empty()) << pass.name;
    EXPECT_EQ(counted.surface.pixels, alone.surface.pixels);
    EXPECT_EQ(counted.volume.pixels, alone.volume.pixels);
  }
}

TEST(FetchCount, IsLowerInModeFast) {
  const hw::PolarVolume volume = testing::noisy_scene();
  const auto total = [&](PipelineMode mode) {
    RenderOptions options = testing::small_options();
    options.pipeline.mode = mode;
    GlContext& context = gl_context();
    const FetchCounter counter;
    const Picture picture = render_volume(context, volume, options);
    std::int64_t sum = 0;
    for (const auto& [fetch, count] : pass_of(picture, "ray_casting").fetches) sum += count;
    return sum;
  };
  EXPECT_LT(total(PipelineMode::fast), total(PipelineMode::plain));
}

TEST(FetchCount, AllowsOneCounterAtATime) {
  gl_context();
  const FetchCounter counter;
  EXPECT_THROW(FetchCounter(), std::logic_error);
}

TEST(FetchRate, IsPositive) {
  gl_context();
  EXPECT_GT(fetch_rate_per_us({Sampler::layers, TexelFormat::rg16, TextureFilter::linear}), 0);
}

}  // namespace
}  // namespace wobblebench::render
