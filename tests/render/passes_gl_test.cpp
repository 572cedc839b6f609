// Each GL pass alone against the same pass of the double-precision reference.
#include <gtest/gtest.h>

#include <cmath>

#include "gl_fixture.h"
#include "render/ray_caster.h"
#include "render/reference_passes.h"
#include "render/scan_converter.h"
#include "render/smoother.h"
#include "render/surface_shader.h"
#include "synthetic.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;

struct FormatCase {
  const char* name;
  TextureFormat format;
  double tolerance;  ///< half a grey level of frame and of slice, or float arithmetic
};

class PassOne : public ::testing::TestWithParam<FormatCase> {};

TEST_P(PassOne, MakesTheReferencesSlices) {
  gl_context();
  for (int filter_size : {1, 3, 7}) {
    const hw::PolarVolume& volume = testing::noisy_scene();
    ScanConversionOptions options{96, filter_size, GetParam().format};
    ScanConverter converter(volume.plan(), options);
    for (int frame : {0, 11, 20}) converter.convert(frame, volume.frame(frame));
    const reference::SliceStack expected(volume, options);
    const std::vector<float> slices = converter.slices().download();
    for (int frame : {0, 11, 20}) {
      double worst = 0;
      for (int row = 0; row < 96; ++row) {
        for (int column = 0; column < 96; ++column) {
          const float got = slices[static_cast<std::size_t>((frame * 96 + row) * 96 + column)];
          worst = std::max(worst, std::abs(got - expected.pixel(frame, column, row)));
        }
      }
      EXPECT_LT(worst, GetParam().tolerance) << "frame " << frame << ", filter " << filter_size;
    }
    for (int i = 0; i < 96 * 96; ++i) {  // frame 1 has not been written
      EXPECT_EQ(slices[static_cast<std::size_t>(96 * 96 + i)], 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formats,
                         PassOne,
                         ::testing::Values(FormatCase{"r8", TextureFormat::r8, 0.51 / 255},
                                           FormatCase{"r16", TextureFormat::r16, 1.2 / 65535},
                                           FormatCase{"r32f", TextureFormat::r32f, 2e-5}),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(PassOneInput, KeepsAConstantFrameConstantUpToTheSectorsEdge) {
  gl_context();
  const hw::AcquisitionPlan plan = testing::small_plan();
  const auto volume = testing::sample_field(plan, [](const glm::dvec3&) { return 0.5; });
  ScanConverter converter(plan, {64, 5, TextureFormat::r32f});
  converter.convert(3, volume.frame(3));
  const std::vector<float> slices = converter.slices().download();
  const std::vector<float> table = make_polar_table(converter.geometry());
  for (std::size_t i = 0; i < 64 * 64; ++i) {
    if (table[3 * i + 2] == 1) {
      EXPECT_FLOAT_EQ(slices[3 * 64 * 64 + i], 0.5f);
    }
  }
}

TEST(PassOneInput, RefusesAFrameOutsideThePlanOrOfAnotherSize) {
  gl_context();
  const hw::PolarVolume& volume = testing::noisy_scene();
  ScanConverter converter(volume.plan(), {64, 1, TextureFormat::r16});
  EXPECT_THROW(converter.convert(21, volume.frame(0)), std::out_of_range);
  EXPECT_THROW(converter.convert(-1, volume.frame(0)), std::out_of_range);
  hw::PolarFrame short_frame = volume.frame(0);
  short_frame.samples.pop_back();
  EXPECT_THROW(converter.convert(0, short_frame), std::invalid_argument);
}

TEST(PassOneInput, CleansSamples) {
  EXPECT_EQ(clean_sample(0.25f), 0.25f);
  EXPECT_EQ(clean_sample(1e30f), 1);
  EXPECT_EQ(clean_sample(-2), 0);
  EXPECT_EQ(clean_sample(std::numeric_limits<float>::infinity()), 0);
  EXPECT_EQ(clean_sample(std::numeric_limits<float>::quiet_NaN()), 0);
}

/// A bumpy height map with holes and cliffs.
Image<double> bumpy_depth(int size) {
  Image<double> depth(size, size, kNoSurface);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double u = double(column) / size - 0.5, v = double(row) / size - 0.5;
      if (std::hypot(u - 0.25, v + 0.2) < 0.08) continue;  // a hole
      const double bump = std::hypot(u + 0.1, v) < 0.2 ? 0.02 : 0.0;
      depth.at(column, row) = 0.07 - bump + 0.004 * std::sin(20 * u) * std::cos(15 * v);
    }
  }
  return depth;
}

Texture upload(const Image<double>& depth) {
  Texture texture(
      "test depth", TexelFormat::r32f, {depth.width, depth.height}, TextureFilter::nearest);
  std::vector<float> values;
  for (double z : depth.pixels) values.push_back(std::isnan(z) ? kNoDepth : static_cast<float>(z));
  texture.upload(values);
  return texture;
}

struct ShadingCase {
  const char* name;
  void (*change)(RenderOptions&);
};

class PassThree : public ::testing::TestWithParam<ShadingCase> {};

TEST_P(PassThree, ShadesLikeTheReference) {
  gl_context();
  RenderOptions options;
  options.ray_casting.image_size = 96;
  GetParam().change(options);
  Image<double> depth = bumpy_depth(96);
  if (options.view.projection == Projection::perspective) {
    for (double& z : depth.pixels) z += options.view.eye_distance_m - 0.07;
  }
  SurfaceShader shader(options);
  shader.shade(upload(depth));
  const auto filtered = reference::filter_depth(depth, options.shading.depth_filter_size);
  const auto shaded = reference::shade(filtered, options);

  const std::vector<float> z = shader.filtered_depth().download();
  const std::vector<float> rgba = shader.surface().download();
  int failing = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    if (std::isnan(filtered.pixels[i])) {
      EXPECT_EQ(z[i], kNoDepth);
    } else {
      EXPECT_NEAR(z[i], filtered.pixels[i], 1e-7);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const double difference = std::abs(rgba[4 * i + c] - shaded.pixels[i][static_cast<int>(c)]);
      failing += difference > 2e-3;
    }
  }
  // What is left are pixels on the border of a shadow, where the last bit of float decides.
  EXPECT_LE(failing, 0.002 * 3 * double(z.size()));
}

const ShadingCase kShadingCases[] = {
    {"defaults", [](RenderOptions&) {}},
    {"unfiltered", [](RenderOptions& o) { o.shading.depth_filter_size = 1; }},
    {"widest_filter", [](RenderOptions& o) { o.shading.depth_filter_size = 15; }},
    {"no_shadows", [](RenderOptions& o) { o.shading.shadows = false; }},
    {"directional_from_the_left",
     [](RenderOptions& o) {
       o.shading.light = Light::directional;
       o.shading.light_left_rad = 50 * kDegree;
     }},
    {"directional_along_the_view",
     [](RenderOptions& o) {
       o.shading.light = Light::directional;
       o.shading.light_up_rad = 0;
     }},
    {"point_near_the_surface",
     [](RenderOptions& o) {
       o.shading.light_distance_m = 0.03;
       o.shading.light_left_rad = -60 * kDegree;
     }},
    {"perspective",
     [](RenderOptions& o) {
       o.view.projection = Projection::perspective;
       o.shading.light_left_rad = 40 * kDegree;
     }},
    {"perspective_directional",
     [](RenderOptions& o) {
       o.view.projection = Projection::perspective;
       o.shading.light = Light::directional;
       o.shading.light_left_rad = 60 * kDegree;
     }},
    {"turned_view",
     [](RenderOptions& o) {
       o.view = {0.5, -0.4, 0.3};
     }},
};

INSTANTIATE_TEST_SUITE_P(Each,
                         PassThree,
                         ::testing::ValuesIn(kShadingCases),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(PassFour, SmoothsLikeTheReference) {
  gl_context();
  RenderOptions options;
  options.ray_casting.image_size = 64;
  const Image<glm::dvec3> picture = reference::shade(bumpy_depth(64), options);
  std::vector<float> rgba;
  for (const glm::dvec3& pixel : picture.pixels) {
    for (int c = 0; c < 3; ++c) rgba.push_back(static_cast<float>(pixel[c]));
    rgba.push_back(1);
  }
  Texture texture("test picture", TexelFormat::rgba32f, {64, 64}, TextureFilter::nearest);
  texture.upload(rgba);
  for (SmoothingFilter filter : {SmoothingFilter::box, SmoothingFilter::bilateral}) {
    for (int size : {1, 3, 5, 9, 15}) {
      const SmoothingOptions smoothing{filter, size, 0.1};
      Smoother smoother(smoothing, 64);
      smoother.smooth(texture);
      const auto expected = reference::smooth(picture, smoothing);
      const std::vector<float> got = smoother.smoothed().download();
      for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
        ASSERT_NEAR(got[4 * i], expected.pixels[i].x, 3e-6) << "size " << size;
        ASSERT_NEAR(got[4 * i + 2], expected.pixels[i].z, 3e-6) << "size " << size;
      }
    }
  }
}

}  // namespace
}  // namespace wobblebench::render
