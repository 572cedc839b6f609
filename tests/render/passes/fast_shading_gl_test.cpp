// Pass 3: mode fast against mode plain, pixel by pixel, for random height maps.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <tuple>

#include "render/camera.h"
#include "render/passes/ray_caster.h"
#include "render/passes/surface_shader.h"
#include "render/picture.h"
#include "tests/render/support/gl_fixture.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;

/// Height map of boxes with random z within 40 mm of `middle_m`, with holes and single pixels
/// missing: cliffs, grooves, and surfaces on both sides of a near light.
std::vector<float> random_relief(int size, double middle_m, unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int end) {
    return static_cast<int>(random() % static_cast<unsigned>(end));
  };
  const auto depth_m = [&] { return static_cast<float>(middle_m - 0.020 + 1e-5 * below(4000)); };
  Image<float> relief(size, size, depth_m());
  for (int box = 0; box < 24; ++box) {
    const float z = box % 4 == 0 ? static_cast<float>(kNoDepth) : depth_m();
    const float slope = 1e-5f * static_cast<float>(below(200) - 100);
    const int left = below(size), top = below(size), side = 1 + below(1 + size / 3);
    for (int row = top; row < std::min(top + side, size); ++row) {
      for (int column = left; column < std::min(left + side, size); ++column) {
        relief.at(column, row) = z < 0 ? z : z + slope * static_cast<float>(column - left);
      }
    }
  }
  for (int i = 0; i < size * size / 50; ++i) relief.at(below(size), below(size)) = kNoDepth;
  return relief.pixels;
}

struct LightCase {
  Light light;
  double left_rad, up_rad, distance_m;
};

/// Along the view, oblique, grazing from each side, and inside the relief. Point lights do not lie
/// above pixel centres or corners, as the pixel of a sample on a border depends on rounding.
const LightCase kLights[] = {
    {Light::directional, 0, 0, 1},
    {Light::directional, 0, 25 * kDegree, 1},
    {Light::directional, 45 * kDegree, -45 * kDegree, 1},
    {Light::directional, 89 * kDegree, 0, 1},
    {Light::directional, -89 * kDegree, 0.1 * kDegree, 1},
    {Light::directional, -70 * kDegree, 89 * kDegree, 1},
    {Light::directional, 2 * kDegree, -88 * kDegree, 1},
    {Light::point, 0, 25 * kDegree, 0.15},
    {Light::point, 60 * kDegree, -10 * kDegree, 0.15},
    {Light::point, -20 * kDegree, 70 * kDegree, 0.05},
    {Light::point, -50 * kDegree, 20 * kDegree, 0.015},
    {Light::point, 89 * kDegree, 0.5 * kDegree, 0.02},
    {Light::point, 1 * kDegree, 2 * kDegree, 0.001},
    {Light::point, 30 * kDegree, 15 * kDegree, 0.004},
    {Light::point, -75 * kDegree, -31 * kDegree, 0.03},
    {Light::point, 11 * kDegree, -61 * kDegree, 0.025},
    {Light::point, -35 * kDegree, 52 * kDegree, 0.01},
};

struct Shaded {
  std::vector<float> z, rgba;
};

Shaded shade(const Texture& depth, RenderOptions options, PipelineMode mode) {
  options.pipeline.mode = mode;
  SurfaceShader shader(options);
  shader.shade(depth, depth);  // the base is constant
  return {shader.filtered_depth().download(), shader.surface().download()};
}

float largest_change(const Shaded& a, const Shaded& b, std::size_t pixel) {
  float largest = 0;
  for (std::size_t c = 0; c < 4; ++c) {
    const float change = std::abs(a.rgba[4 * pixel + c] - b.rgba[4 * pixel + c]);
    largest = std::isnan(change) ? 1e30f : std::max(largest, change);
  }
  return largest;
}

class FastShading : public ::testing::TestWithParam<std::tuple<Projection, int>> {
 protected:
  static RenderOptions options() {
    RenderOptions options;
    const auto& [projection, size] = GetParam();
    options.view.projection = projection;
    options.ray_casting.image_size = size;
    return options;
  }
};

TEST_P(FastShading, EqualsModePlain) {
  gl_context();
  RenderOptions o = options();
  const int size = o.ray_casting.image_size;
  const Camera camera = make_camera(o);
  const bool parallel = o.view.projection == Projection::parallel;
  const double middle_m = parallel ? camera.plane_distance_m : camera.eye_distance_m;
  int pixels = 0, other = 0, dark = 0;
  unsigned seed = 0;
  for (const LightCase& light : kLights) {
    o.shading.light = light.light;
    o.shading.light_left_rad = light.left_rad;
    o.shading.light_up_rad = light.up_rad;
    o.shading.light_distance_m = light.distance_m;
    o.shading.depth_filter_size = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 5 : 15;
    o.shading.shadow_bias_m = seed % 2 == 0 ? 0.8e-3 : 1e-5;
    Texture depth("test depth", TexelFormat::r32f, {size, size}, TextureFilter::nearest);
    depth.upload(random_relief(size, middle_m, ++seed));
    const Shaded plain = shade(depth, o, PipelineMode::plain);
    const Shaded fast = shade(depth, o, PipelineMode::fast);
    o.shading.shadows = false;
    const Shaded unshadowed = shade(depth, o, PipelineMode::plain);
    o.shading.shadows = true;
    for (std::size_t i = 0; i < plain.z.size(); ++i) {
      ASSERT_NEAR(fast.z[i], plain.z[i], 1e-7) << "light " << seed << ", pixel " << i;
      other += largest_change(plain, fast, i) > 2e-3f;
      dark += largest_change(plain, unshadowed, i) > 2e-3f;
      ++pixels;
    }
  }
  // Float rounding can move a sample across a pixel's border or across the bias.
  EXPECT_LE(other, 1e-3 * pixels);
  if (size >= 8) {
    EXPECT_GT(dark, 0.1 * pixels);
    EXPECT_LT(dark, 0.9 * pixels);
  }
  RecordProperty("other_share", std::to_string(double(other) / pixels));
}

std::string case_name(const ::testing::TestParamInfo<FastShading::ParamType>& info) {
  const auto& [projection, size] = info.param;
  return (projection == Projection::parallel ? "parallel_" : "perspective_") + std::to_string(size);
}

// One pixel; smaller than a kernel or a tile; whole tiles; partial tiles.
INSTANTIATE_TEST_SUITE_P(Sizes,
                         FastShading,
                         ::testing::Combine(::testing::Values(Projection::parallel,
                                                              Projection::perspective),
                                            ::testing::Values(1, 5, 13, 64, 150)),
                         case_name);

// Rays that descend to a light inside the relief pass below a low cover only at their end.
TEST(FastShadingInput, ACoverBesideALowLightCastsItsShadow) {
  gl_context();
  RenderOptions o;
  o.ray_casting.image_size = 64;
  o.shading.depth_filter_size = 1;
  o.shading.light_distance_m = 0.001;
  o.shading.light_left_rad = 1 * kDegree;
  o.shading.light_up_rad = 2 * kDegree;
  const auto light_m = static_cast<float>(make_camera(o).plane_distance_m - 0.001);
  Image<float> relief(64, 64, light_m - 0.020f);
  for (int row = 0; row < 64; ++row) {
    for (int column = 16; column < 64; ++column) relief.at(column, row) = light_m + 0.005f;
    for (int column = 29; column < 31; ++column) relief.at(column, row) = light_m - 0.003f;
  }
  Texture depth("test depth", TexelFormat::r32f, {64, 64}, TextureFilter::nearest);
  depth.upload(relief.pixels);
  const Shaded plain = shade(depth, o, PipelineMode::plain);
  const Shaded fast = shade(depth, o, PipelineMode::fast);
  o.shading.shadows = false;
  const Shaded unshadowed = shade(depth, o, PipelineMode::plain);
  for (std::size_t column = 0; column < 16; ++column) {  // the next one is lit over the ledge
    const std::size_t pixel = 64 * 32 + column;
    EXPECT_LT(plain.rgba[4 * pixel], 0.7f * unshadowed.rgba[4 * pixel]) << column;
    EXPECT_LT(largest_change(plain, fast, pixel), 2e-3f) << column;
  }
}

}  // namespace
}  // namespace wobblebench::render
