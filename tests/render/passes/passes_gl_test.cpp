// Each GL pass against the same pass of the double-precision reference.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <tuple>

#include "render/passes/ray_caster.h"
#include "render/passes/slice_volume.h"
#include "render/passes/smoother.h"
#include "render/passes/surface_shader.h"
#include "render/reference/reference_passes.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/settings.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;

struct FormatCase {
  const char* name;
  TextureFormat format;
  double tolerance;  ///< half a grey level of frame and of slice each, or float rounding
};

class PassOne : public ::testing::TestWithParam<std::tuple<FormatCase, PipelineMode>> {};

/// The whole of each slice, and no 3D kernel.
RenderOptions slice_options(int slice_size, int filter_size, TextureFormat format) {
  RenderOptions options;
  options.scan_conversion = {slice_size, filter_size, format};
  options.ray_casting.stop_at_box = false;
  options.ray_casting.kernel_3d = 1;
  return options;
}

/// Layers of the volume texture that hold the slices of `frames`, made as the renderer makes them;
/// the others stay zero.
class Layers {
 public:
  Layers(const hw::PolarVolume& volume,
         const RenderOptions& options,
         const std::vector<int>& frames)
      : factory_(volume.plan(), options), made_(factory_.make()) {
    FrameStore store(volume.plan(), options);
    const int count = factory_.geometry().frames();
    for (int f = 0; f < count; ++f) store.put(f, volume.frame(f));
    const int last_layer = made_->slices().extent().depth - 1;
    std::vector<int> layers;
    for (int f : frames) layers.push_back(std::min(f, last_layer));
    made_->make_layers(layers, store);
    for (int f = 0; f < count; ++f) slices_.push_back(made_->download_slice(f));
  }

  Region pixels() const { return made_->pixels(); }
  float at(int frame, int column, int row) const {
    const Region p = pixels();
    return slices_[static_cast<std::size_t>(frame)].at(column - p.column, row - p.row);
  }

 private:
  SliceVolumeFactory factory_;
  std::unique_ptr<SliceVolume> made_;
  std::vector<Image<float>> slices_;
};

double worst_difference(const Layers& layers, const reference::SliceStack& expected, int frame) {
  const Region region = layers.pixels();
  double worst = 0;
  for (int row = region.row; row < region.row + region.rows; ++row) {
    for (int column = region.column; column < region.column + region.columns; ++column) {
      worst = std::max(
          worst, std::abs(layers.at(frame, column, row) - expected.pixel(frame, column, row)));
    }
  }
  return worst;
}

TEST_P(PassOne, EqualsTheReference) {
  gl_context();
  const auto [format, mode] = GetParam();
  const hw::PolarVolume& volume = testing::noisy_scene();
  for (int kernel : {1, 3, 5}) {
    for (int filter_size : {1, 3, 7}) {
      RenderOptions options = slice_options(96, filter_size, format.format);
      options.pipeline.mode = mode;
      options.ray_casting.kernel_3d = kernel;
      const reference::SliceStack expected(volume, options);
      const Layers layers(volume, options, {0, 11, 20});
      for (int frame : {0, 11, 20}) {
        EXPECT_LT(worst_difference(layers, expected, frame), format.tolerance)
            << "frame " << frame << ", filter " << filter_size << ", kernel " << kernel;
      }
      for (int i = 0; i < 96; ++i) EXPECT_EQ(layers.at(5, i, i), 0);  // not made
    }
  }
}

const FormatCase kFormats[] = {{"r8", TextureFormat::r8, 0.51 / 255},
                               {"r16", TextureFormat::r16, 1.2 / 65535},
                               {"r32f", TextureFormat::r32f, 2e-5}};

INSTANTIATE_TEST_SUITE_P(Formats,
                         PassOne,
                         ::testing::Combine(::testing::ValuesIn(kFormats),
                                            ::testing::Values(PipelineMode::fast,
                                                              PipelineMode::plain)),
                         testing::NamedByCaseAndMode{});

TEST(PassOneInput, InModeFastOnlyPixelsThatRaysReadAreStored) {
  gl_context();
  const hw::PolarVolume& volume = testing::noisy_scene();
  RenderOptions options = testing::small_options();
  options.pipeline.mode = PipelineMode::fast;
  const int size = options.scan_conversion.slice_size;
  const Layers layers(volume, options, {11});
  EXPECT_LT(layers.pixels().columns * layers.pixels().rows, size * size / 2);
  const reference::SliceStack expected(volume, options);
  EXPECT_LT(worst_difference(layers, expected, 11), 2.0 / 65535);
}

TEST(PassOneInput, AConstantFrameIsConstantUpToTheSectorsEdge) {
  gl_context();
  const hw::AcquisitionPlan plan = testing::small_plan();
  const auto volume = testing::sample_field(plan, [](const glm::dvec3&) { return 0.5; });
  const std::vector<float> table = make_polar_table(SliceGeometry(plan, 64), {0, 0, 64, 64});
  for (PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    RenderOptions options = slice_options(64, 5, TextureFormat::r32f);
    options.pipeline.mode = mode;
    const Layers layers(volume, options, {3});
    for (int i = 0; i < 64 * 64; ++i) {
      if (table[static_cast<std::size_t>(3 * i + 2)] == 1) {
        EXPECT_NEAR(layers.at(3, i % 64, i / 64), 0.5f, 2e-7);
      }
    }
  }
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

/// A volume picture with a gradient and a grid of dark pixels.
Image<glm::dvec3> striped_picture(int size) {
  Image<glm::dvec3> picture(size, size);
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const double grey = (row + column) % 3 == 0 ? 0.1 : double(column + 1) / size;
      picture.at(column, row) = {grey, 0.5 * grey, 1 - grey};
    }
  }
  return picture;
}

Texture upload(const Image<glm::dvec3>& picture) {
  Texture texture("test picture",
                  TexelFormat::rgba32f,
                  {picture.width, picture.height},
                  TextureFilter::nearest);
  std::vector<float> rgba;
  for (const glm::dvec3& pixel : picture.pixels) {
    for (int c = 0; c < 3; ++c) rgba.push_back(static_cast<float>(pixel[c]));
    rgba.push_back(1);
  }
  texture.upload(rgba);
  return texture;
}

struct ShadingCase {
  const char* name;
  const char* settings;
};

class PassThree : public ::testing::TestWithParam<std::tuple<PipelineMode, ShadingCase>> {};

TEST_P(PassThree, ShadesLikeTheReference) {
  gl_context();
  RenderOptions options;
  options.ray_casting.image_size = 96;
  const auto& [mode, shading_case] = GetParam();
  options.pipeline.mode = mode;
  testing::set(options, shading_case.settings);
  Image<double> depth = bumpy_depth(96);
  if (options.view.projection == Projection::perspective) {
    for (double& z : depth.pixels) z += options.view.eye_distance_m - 0.07;
  }
  SurfaceShader shader(options);
  const Image<glm::dvec3> rendered = striped_picture(96);
  shader.shade(upload(depth), upload(rendered));
  const auto filtered = reference::filter_depth(depth, options.shading.depth_filter_size);
  const auto shaded = reference::shade(filtered, rendered, options);

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
  // The rest are pixels on the border of a shadow, where float rounding decides.
  EXPECT_LE(failing, 0.002 * 3 * double(z.size()));
}

const ShadingCase kShadingCases[] = {
    {"defaults", ""},
    {"unfiltered", "shading.depth_filter_size=1"},
    {"widest_filter", "shading.depth_filter_size=15"},
    {"no_shadows", "shading.shadows=false"},
    {"mirrored", "view.flip=true"},
    {"directional_from_the_left", "shading.light=directional shading.light_left_deg=50"},
    {"directional_along_the_view", "shading.light=directional shading.light_up_deg=0"},
    {"point_near_the_surface", "shading.light_distance_mm=30 shading.light_left_deg=-60"},
    {"perspective", "view.projection=perspective shading.light_left_deg=40"},
    {"perspective_directional",
     "view.projection=perspective shading.light=directional shading.light_left_deg=60"},
    {"turned_view", "view.yaw_deg=29 view.pitch_deg=-23 view.roll_deg=17"},
    {"rendered_base", "shading.base=rendered"},
    {"rendered_base_directional",
     "shading.base=rendered shading.base_rgb=1,1,1 shading.light=directional "
     "shading.light_left_deg=50"},
};

std::string shading_name(const ::testing::TestParamInfo<PassThree::ParamType>& info) {
  const auto& [mode, shading_case] = info.param;
  return std::string(mode == PipelineMode::fast ? "fast_" : "plain_") + shading_case.name;
}

INSTANTIATE_TEST_SUITE_P(Lights,
                         PassThree,
                         ::testing::Combine(::testing::Values(PipelineMode::plain,
                                                              PipelineMode::fast),
                                            ::testing::ValuesIn(kShadingCases)),
                         shading_name);

struct SmoothingCase {
  const char* name;
  PipelineMode mode;
  SmoothingFilter filter;
};

class PassFour : public ::testing::TestWithParam<SmoothingCase> {};

void expect_smoothed(const Image<glm::dvec3>& picture,
                     const SmoothingOptions& options,
                     PipelineMode mode) {
  Smoother smoother(options, picture.width, mode);
  smoother.smooth(upload(picture));
  const auto expected = reference::smooth(picture, options);
  const std::vector<float> got = smoother.smoothed().download();
  for (std::size_t i = 0; i < expected.pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      ASSERT_NEAR(got[4 * i + c], expected.pixels[i][static_cast<int>(c)], 3e-6)
          << picture.width << " pixels, size " << options.filter_size << ", pixel " << i;
    }
  }
}

TEST_P(PassFour, SmoothsLikeTheReference) {
  gl_context();
  RenderOptions options;
  options.ray_casting.image_size = 64;
  const Image<glm::dvec3> picture = reference::shade(bumpy_depth(64), {}, options);
  for (int size : {1, 3, 5, 9, 15}) {
    expect_smoothed(picture, {GetParam().filter, size, 0.1}, GetParam().mode);
  }
}

TEST_P(PassFour, SmoothsNoiseOfAnySizeLikeTheReference) {
  gl_context();
  for (int side : {1, 2, 7, 33}) {
    std::mt19937 random(static_cast<unsigned>(side));
    Image<glm::dvec3> picture(side, side);
    for (glm::dvec3& pixel : picture.pixels) {
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<float>(random() % 256) / 255;
    }
    for (int size : {1, 3, 9, 15}) {
      for (double range_sigma : {0.05, 0.1, 10.0}) {
        expect_smoothed(picture, {GetParam().filter, size, range_sigma}, GetParam().mode);
      }
    }
  }
}

const SmoothingCase kSmoothingCases[] = {
    {"plain_box", PipelineMode::plain, SmoothingFilter::box},
    {"plain_bilateral", PipelineMode::plain, SmoothingFilter::bilateral},
    {"plain_guided", PipelineMode::plain, SmoothingFilter::guided},
    {"fast_box", PipelineMode::fast, SmoothingFilter::box},
    {"fast_bilateral", PipelineMode::fast, SmoothingFilter::bilateral},
    {"fast_guided", PipelineMode::fast, SmoothingFilter::guided},
};

INSTANTIATE_TEST_SUITE_P(Filters,
                         PassFour,
                         ::testing::ValuesIn(kSmoothingCases),
                         [](const auto& param_info) { return param_info.param.name; });

}  // namespace
}  // namespace wobblebench::render
