// Closed forms of passes 3 and 4, and the reference on blank and uniform data. passes_gl_test and
// agreement_gl_test compare the GL passes with the reference.
#include "render/reference/reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/camera.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

using testing::hits;

/// 64 pixels over 0.1 m, no filters, directional light.
RenderOptions bare_options() {
  RenderOptions options;
  options.ray_casting.image_size = 64;
  options.shading.depth_filter_size = 1;
  options.shading.light = Light::directional;
  options.shading.shadow_bias_m = 0;
  options.smoothing.filter_size = 1;
  return options;
}

TEST(ShadeDepth, AFlatSurfaceHasTheValueOfEquation2) {
  RenderOptions options = bare_options();
  options.shading.light_left_rad = 20 * kDegree;
  options.shading.light_up_rad = 30 * kDegree;
  const Picture picture = shade_depth(Image<float>(64, 64, 0.05f), options);
  const ShadingOptions& o = options.shading;
  const double cos_light = std::cos(20 * kDegree) * std::cos(30 * kDegree);
  const double cos_half = std::sqrt((1 + cos_light) / 2);  // half of the angle to the light
  for (int channel = 0; channel < 3; ++channel) {
    const double base = o.base_rgb[static_cast<std::size_t>(channel)];
    const double expected =
        base * (o.ambient + o.diffuse * cos_light) + o.specular * std::pow(cos_half, o.shininess);
    for (const glm::vec3& pixel : picture.surface.pixels) {
      EXPECT_NEAR(pixel[channel], std::min(expected, 1.0), 1e-7);
    }
  }
}

/// Ambient and diffuse light fall on the rendered picture, the highlight on top of it.
TEST(ShadeDepth, OnTheRenderedPictureItsPixelsAreTheBase) {
  RenderOptions options = bare_options();
  options.shading.base = ShadingBase::rendered;
  options.shading.base_rgb = {1, 0.5, 0.25};
  options.shading.light_left_rad = 20 * kDegree;
  options.shading.light_up_rad = 0;
  Image<glm::vec3> rendered(64, 64);
  for (int i = 0; i < 64 * 64; ++i) {
    rendered.pixels[static_cast<std::size_t>(i)] = glm::vec3(static_cast<float>(i % 64) / 128);
  }
  const Picture picture = shade_depth(Image<float>(64, 64, 0.05f), options, rendered);
  const ShadingOptions& o = options.shading;
  const double light = o.ambient + o.diffuse * std::cos(20 * kDegree);
  const double highlight = o.specular * std::pow(std::cos(10 * kDegree), o.shininess);
  for (const int column : {0, 10, 63}) {
    const double grey = column / 128.0;
    EXPECT_NEAR(picture.surface.at(column, 30).r, grey * light + highlight, 1e-6);
    EXPECT_NEAR(picture.surface.at(column, 30).b, 0.25 * grey * light + highlight, 1e-6);
  }
  EXPECT_THROW(shade_depth(Image<float>(64, 64, 0.05f), options, Image<glm::vec3>(8, 8)),
               InvalidOption);
}

TEST(ShadeDepth, ASlopeThatFacesTheLightIsFullyLit) {
  RenderOptions options = bare_options();
  options.shading.ambient = 0.15;
  options.shading.diffuse = 0.75;
  options.shading.specular = 0;
  options.shading.light_up_rad = 0;
  options.shading.light_left_rad = 30 * kDegree;
  const Camera camera = make_camera(options);
  Image<float> depth(64, 64);
  // Nearer to the right: the surface turns left, by 30 degrees, to face the light.
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const double right_m = column * camera.pixel_m();
      depth.at(column, row) = static_cast<float>(0.09 - right_m * std::tan(30 * kDegree));
    }
  }
  const Picture picture = shade_depth(depth, options);
  const double full = options.shading.base_rgb[0] * 0.9;
  EXPECT_NEAR(picture.surface.at(32, 32).r, full, 1e-5);
}

TEST(ShadeDepth, AStepCastsAShadowOfItsHeightTimesTheTangent) {
  for (double bias_m : {0.0, 2e-3}) {
    RenderOptions options = bare_options();
    options.shading.light_left_rad = 60 * kDegree;
    options.shading.light_up_rad = 0;
    options.shading.shadow_bias_m = bias_m;
    const double height_m = 0.010, pixel_m = make_camera(options).pixel_m();
    Image<float> depth(64, 64, 0.06f);
    for (int row = 0; row < 64; ++row) {
      for (int column = 0; column < 20; ++column) depth.at(column, row) = 0.05f;
    }
    const Picture lit = [&] {
      RenderOptions unshadowed = options;
      unshadowed.shading.shadows = false;
      return shade_depth(depth, unshadowed);
    }();
    const Picture picture = shade_depth(depth, options);
    int shadowed = 0;
    for (int column = 0; column < 64; ++column) {
      const float ratio = picture.surface.at(column, 32).r / lit.surface.at(column, 32).r;
      const bool dark = ratio < 0.99f;
      if (dark) {
        EXPECT_NEAR(ratio, options.shading.shadow_coefficient, 1e-5);
      }
      if (dark) {
        EXPECT_GE(column, 20);
      }
      shadowed += dark;
    }
    const double length_pixels = (height_m - bias_m) * std::tan(60 * kDegree) / pixel_m;
    EXPECT_NEAR(shadowed, length_pixels, 1);
  }
}

TEST(ShadeDepth, IsBlackWithoutASurface) {
  const Picture picture = shade_depth(Image<float>(64, 64, kNoSurface), bare_options());
  for (const glm::vec3& pixel : picture.surface.pixels) EXPECT_EQ(pixel, glm::vec3(0));
  EXPECT_EQ(hits(picture.filtered_depth_m), 0);
}

TEST(ShadeDepth, RefusesAPictureOfAnotherSize) {
  EXPECT_THROW(shade_depth(Image<float>(32, 64), bare_options()), InvalidOption);
}

TEST(ShadeDepth, FiltersPreserveConstants) {
  RenderOptions options = bare_options();
  options.shading.depth_filter_size = 9;
  options.shading.light_up_rad = 0.3;
  const Picture plain = shade_depth(Image<float>(64, 64, 0.05f), bare_options());
  for (SmoothingFilter filter :
       {SmoothingFilter::box, SmoothingFilter::bilateral, SmoothingFilter::guided}) {
    options.smoothing.filter = filter;
    options.smoothing.filter_size = 9;
    const Picture picture = shade_depth(Image<float>(64, 64, 0.05f), options);
    for (float z : picture.filtered_depth_m.pixels) EXPECT_EQ(z, 0.05f);
    const glm::vec3 first = picture.surface.at(0, 0);
    for (const glm::vec3& pixel : picture.surface.pixels) {
      EXPECT_NEAR(pixel.r, first.r, 1e-6);
      EXPECT_GT(pixel.r, 0.5f);
    }
  }
}

TEST(ShadeDepth, BilateralPreservesAnEdgeThatTheBoxBlurs) {
  RenderOptions options = bare_options();
  options.shading.shadows = false;
  Image<float> depth(64, 64, kNoSurface);
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 32; ++column) depth.at(column, row) = 0.05f;
  }
  options.smoothing.filter_size = 5;
  const float box = shade_depth(depth, options).surface.at(32, 32).r;
  options.smoothing.filter = SmoothingFilter::bilateral;
  const float bilateral = shade_depth(depth, options).surface.at(32, 32).r;
  EXPECT_GT(box, 0.2f);
  EXPECT_LT(bilateral, 1e-3f);
}

TEST(Reference, BlankDataHasNoSurfaceAndNoPicture) {
  const auto volume =
      testing::sample_field(testing::small_plan(), [](const glm::dvec3&) { return 0.0; });
  RenderOptions options = testing::small_options();
  options.ray_casting.image_size = 16;
  const Picture picture = render_reference(volume, options);
  EXPECT_EQ(hits(picture.depth_m), 0);
  for (const glm::vec3& pixel : picture.volume.pixels) EXPECT_EQ(pixel, glm::vec3(0));
}

TEST(Reference, UniformDataHasTheOpacityOfItsLength) {
  const auto volume =
      testing::sample_field(testing::small_plan(), [](const glm::dvec3&) { return 0.35; });
  RenderOptions options = testing::small_options();
  options.ray_casting.image_size = 8;
  options.ray_casting.mode = RenderMode::volume;
  options.ray_casting.opacity_limit = 2;
  options.volume_of_interest.center_m = {0, 0, 0.12};
  options.volume_of_interest.size_m = {0.02, 0.02, 0.01};
  const Picture picture = render_reference(volume, options);
  // 0.35 lies midway between the knots at 0.2 and 0.5: opacity 0.125 a mm, grey 0.4; 10 mm of it.
  const double expected = 0.4 * (1 - std::pow(1 - 0.125, 10));
  for (const glm::vec3& pixel : picture.volume.pixels) EXPECT_NEAR(pixel.r, expected, 1e-6);
}

}  // namespace
}  // namespace wobblebench::render
