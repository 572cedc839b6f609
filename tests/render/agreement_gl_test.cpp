// Whole pictures: both modes of the GL pipeline against the double-precision reference, with each
// setting changed once; mode fast against mode plain for several scenes, views and random settings.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <ostream>
#include <random>
#include <string>
#include <tuple>

#include "render/camera.h"
#include "render/reference/reference.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

/// How far two pictures may be from each other.
struct Bounds {
  double z_rms_steps = 0.1;
  double changed_share = 0.001;  ///< of pixels with a surface in only one
  double blended_share = 0.005;  ///< of pixels more than 0.005 off in the volume picture
  double surface_share = 0.01;   ///< of pixels more than 0.01 off in the surface picture
};

/// Returns how many pixels have a surface in both.
int expect_same(const Picture& got,
                const Picture& expected,
                const Bounds& bounds,
                const RenderOptions& options) {
  const auto depth = testing::compare(got.depth_m, expected.depth_m);
  EXPECT_LE(depth.rms_m, bounds.z_rms_steps * step_m(options));
  EXPECT_LE(depth.changed_share, bounds.changed_share);
  const auto filtered = testing::compare(got.filtered_depth_m, expected.filtered_depth_m);
  EXPECT_LE(filtered.rms_m, bounds.z_rms_steps * step_m(options));
  const auto surface = testing::compare(got.surface, expected.surface, 0.01);
  EXPECT_LE(surface.failing_share, bounds.surface_share)
      << "largest difference " << surface.largest;
  const auto blended = testing::compare(got.volume, expected.volume, 0.005);
  EXPECT_LE(blended.failing_share, bounds.blended_share)
      << "largest difference " << blended.largest;
  return depth.both;
}

/// In this mode of the pipeline.
Picture rendered(const hw::PolarVolume& volume, RenderOptions options, PipelineMode mode) {
  options.pipeline.mode = mode;
  return render_volume(testing::gl_context(), volume, options);
}

struct Setting {
  const char* name;
  void (*change)(RenderOptions&);
  double z_rms_steps = 0.02;
  double changed_share = 0.001;
  double blended_share = 0.002;
  double golden_share = 0.01;  ///< of pixels more than 3 grey levels off in the golden sheet
};
void PrintTo(const Setting& setting, std::ostream* out) {
  *out << setting.name;
}

class EachSetting : public ::testing::TestWithParam<Setting> {};

TEST_P(EachSetting, RendersLikeTheReferenceInBothModes) {
  RenderOptions options = testing::small_options();
  const Setting& setting = GetParam();
  setting.change(options);
  const hw::PolarVolume& volume = testing::noisy_scene();
  const Picture expected = render_reference(volume, options);
  const bool detects_surface = options.ray_casting.mode != RenderMode::volume;
  EXPECT_EQ(testing::hits(expected.depth_m) > 0, detects_surface);
  const Bounds bounds{setting.z_rms_steps, setting.changed_share, setting.blended_share};
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    SCOPED_TRACE(mode == PipelineMode::fast ? "fast" : "plain");
    expect_same(rendered(volume, options, mode), expected, bounds, options);
  }
}

const Setting kSettings[] = {
    {"defaults", [](RenderOptions&) {}},
    {"kernel_none", [](RenderOptions& o) { o.ray_casting.kernel_3d = 1; }},
    {"kernel_5", [](RenderOptions& o) { o.ray_casting.kernel_3d = 5; }},
    {"ray_kernel_3", [](RenderOptions& o) { o.ray_casting.kernel_space = KernelSpace::ray; }},
    {"ray_kernel_5",
     [](RenderOptions& o) {
       o.ray_casting.kernel_space = KernelSpace::ray;
       o.ray_casting.kernel_3d = 5;
     }},
    {"buffer_2",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 2;
       o.ray_casting.threshold = 0.12;
     }},
    {"buffer_16",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 16;
       o.ray_casting.threshold = 2;
     }},
    {"buffer_64",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 64;
       o.ray_casting.threshold = 4;
     }},
    // In noise Difference crosses 0 slowly, so rounding decides where.
    {"threshold_zero", [](RenderOptions& o) { o.ray_casting.threshold = 0; }, 0.5},
    {"threshold_negative", [](RenderOptions& o) { o.ray_casting.threshold = -1; }},
    {"edge_falling",
     [](RenderOptions& o) {
       o.ray_casting.edge = EdgeSign::falling;
       o.ray_casting.mode = RenderMode::surface;
     }},
    {"window_3", [](RenderOptions& o) { o.ray_casting.window_2d = 3; }},
    {"window_5_without_kernel",
     [](RenderOptions& o) {
       o.ray_casting.window_2d = 5;
       o.ray_casting.kernel_3d = 1;
     }},
    // One pixel of 1600 that is detected a step apart is 0.025 steps RMS.
    {"unrefined_crossing", [](RenderOptions& o) { o.ray_casting.refine_crossing = false; }, 0.05},
    {"goes_on_beyond_the_box", [](RenderOptions& o) { o.ray_casting.stop_at_box = false; }},
    {"goes_on_beyond_the_cone",
     [](RenderOptions& o) {
       o.ray_casting.stop_on_leaving_cone = false;
       o.view.yaw_rad = 70 * kDegree;
     }},
    {"early_opaque", [](RenderOptions& o) { o.ray_casting.opacity_limit = 0.3; }},
    {"never_opaque", [](RenderOptions& o) { o.ray_casting.opacity_limit = 2; }},
    {"transfer_function",
     [](RenderOptions& o) {
       o.ray_casting.transfer_values = {0.1, 0.4, 0.9};
       o.ray_casting.transfer_opacity_per_mm = {0, 0.9, 0.1};
       o.ray_casting.transfer_grey = {1, 0.2, 0.7};
     }},
    {"mode_surface", [](RenderOptions& o) { o.ray_casting.mode = RenderMode::surface; }},
    {"mode_volume", [](RenderOptions& o) { o.ray_casting.mode = RenderMode::volume; }},
    {"few_steps",
     [](RenderOptions& o) {
       o.ray_casting.steps = 16;
       o.ray_casting.buffer_length = 2;
       o.ray_casting.threshold = 0.2;
     }},
    {"format_r32f", [](RenderOptions& o) { o.scan_conversion.format = TextureFormat::r32f; }},
    // 8-bit samples and 8-bit filter weights change Difference and z: the bounds show by how much,
    // and why r8 is not the default.
    {"format_r8",
     [](RenderOptions& o) { o.scan_conversion.format = TextureFormat::r8; },
     1.5,
     0.01,
     0.02},
    {"slice_filter_none", [](RenderOptions& o) { o.scan_conversion.filter_size = 1; }},
    {"slice_filter_7", [](RenderOptions& o) { o.scan_conversion.filter_size = 7; }},
    {"odd_slice_size", [](RenderOptions& o) { o.scan_conversion.slice_size = 101; }},
    {"perspective", [](RenderOptions& o) { o.view.projection = Projection::perspective; }},
    // At ray lengths of 10 m float resolves 1e-6 m, a thousandth of a step here.
    {"perspective_from_afar",
     [](RenderOptions& o) {
       o.view.projection = Projection::perspective;
       o.view.eye_distance_m = 10;
     }},
    {"perspective_eye_inside",
     [](RenderOptions& o) {
       o.view.projection = Projection::perspective;
       o.view.eye_distance_m = 0.03;
     }},
    {"view_from_the_right", [](RenderOptions& o) { o.view.yaw_rad = 40 * kDegree; }},
    {"view_from_above", [](RenderOptions& o) { o.view.pitch_rad = 35 * kDegree; }},
    {"view_from_below_left",
     [](RenderOptions& o) {
       o.view = {-0.5, -0.4, 0.3};
     }},
    {"view_along_x", [](RenderOptions& o) { o.view.yaw_rad = 90 * kDegree; }},
    {"view_from_behind",
     [](RenderOptions& o) {
       o.view.yaw_rad = 170 * kDegree;
       o.view.projection = Projection::perspective;
     }},
    {"light_directional", [](RenderOptions& o) { o.shading.light = Light::directional; }},
    {"light_left", [](RenderOptions& o) { o.shading.light_left_rad = 45 * kDegree; }},
    {"no_shadows", [](RenderOptions& o) { o.shading.shadows = false; }},
    {"depth_filter_none", [](RenderOptions& o) { o.shading.depth_filter_size = 1; }},
    {"smoothing_low", [](RenderOptions& o) { o.smoothing.filter_size = 5; }},
    {"smoothing_bilateral",
     [](RenderOptions& o) { o.smoothing.filter = SmoothingFilter::bilateral; }},
    {"smoothing_guided", [](RenderOptions& o) { o.smoothing.filter = SmoothingFilter::guided; }},
    {"box_partly_outside_the_cone",
     [](RenderOptions& o) {
       o.volume_of_interest.center_m = {0.05, 0.03, 0.13};
       o.volume_of_interest.size_m = {0.2, 0.2, 0.16};
     }},
};

/// Beside the golden sheet. `paper`: every step as the paper writes it
/// (docs/decisions/0006-defaults-of-the-probe.md).
const Setting kBaseSettings[] = {
    {"base_rendered", [](RenderOptions& o) { o.shading.base = ShadingBase::rendered; }},
    {"paper",
     [](RenderOptions& o) {
       o.ray_casting.kernel_space = KernelSpace::ray;
       o.ray_casting.refine_crossing = false;
       o.shading.base = ShadingBase::rendered;
       o.shading.base_rgb = {1, 1, 1};
     },
     0.05},
    {"buffer_of_millimetres",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length_m = 20 * step_m(o);
       o.ray_casting.threshold = 2;
     }},
    {"buffer_30",  // no multiple of a block
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 30;
       o.ray_casting.threshold = 3;
     }},
    {"buffer_64_beyond_the_cone",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 64;
       o.ray_casting.threshold = 4;
       o.ray_casting.stop_on_leaving_cone = false;
       o.view.yaw_rad = 70 * kDegree;
     }},
    {"buffer_64_of_a_ray_kernel",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 64;
       o.ray_casting.threshold = 4;
       o.ray_casting.kernel_space = KernelSpace::ray;
     }},
    {"detector_iso", [](RenderOptions& o) { o.ray_casting.detector = Detector::iso; }},
    {"detector_iso_falling",
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::iso;
       o.ray_casting.edge = EdgeSign::falling;
       o.ray_casting.mode = RenderMode::surface;
     }},
    {"detector_iso_in_rays",
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::iso;
       o.ray_casting.kernel_space = KernelSpace::ray;
     }},
    {"detector_floor", [](RenderOptions& o) { o.ray_casting.detector = Detector::floor; }},
    {"detector_floor_of_surfaces_alone",  // leaps farther: nothing is blended
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::floor;
       o.ray_casting.mode = RenderMode::surface;
     }},
    {"detector_floor_falling",
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::floor;
       o.ray_casting.edge = EdgeSign::falling;
       o.ray_casting.mode = RenderMode::surface;
     }},
    {"detector_floor_beyond_the_cone",
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::floor;
       o.ray_casting.stop_on_leaving_cone = false;
       o.view.yaw_rad = 70 * kDegree;
     }},
    {"detector_floor_of_a_ray_kernel",
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::floor;
       o.ray_casting.kernel_space = KernelSpace::ray;
     }},
    {"sticks_aligned", [](RenderOptions& o) { o.reconstruction.sticks = Sticks::aligned; }},
    {"sticks_aligned_iso",
     [](RenderOptions& o) {
       o.reconstruction.sticks = Sticks::aligned;
       o.ray_casting.detector = Detector::iso;
     }},
    {"incidence_corrected",
     [](RenderOptions& o) {
       o.ray_casting.incidence_correction_m = 1e-3;
       o.view.yaw_rad = 0.4;
     }},
    {"incidence_corrected_in_perspective",
     [](RenderOptions& o) {
       o.ray_casting.incidence_correction_m = 1e-3;
       o.view.projection = Projection::perspective;
     }},
    {"small_pieces_left_out", [](RenderOptions& o) { o.ray_casting.smallest_piece_m2 = 50e-6; }},
    {"incidence_corrected_by_the_beam",
     [](RenderOptions& o) {
       o.ray_casting.incidence_correction_m.reset();
       o.view.yaw_rad = 0.4;
     }},
};

/// All settings' shaded pictures side by side, as 8-bit grey.
Image<std::uint8_t> golden_sheet() {
  constexpr int kTile = 40, kColumns = 8;
  const int count = static_cast<int>(std::size(kSettings));
  Image<std::uint8_t> sheet(kColumns * kTile, (count + kColumns - 1) / kColumns * kTile);
  for (int k = 0; k < count; ++k) {
    RenderOptions options = testing::small_options();
    kSettings[k].change(options);
    const Picture picture = render_volume(testing::gl_context(), testing::noisy_scene(), options);
    const bool blended = options.ray_casting.mode == RenderMode::volume;
    for (int row = 0; row < kTile; ++row) {
      for (int column = 0; column < kTile; ++column) {
        const float grey = (blended ? picture.volume : picture.surface).at(column, row).g;
        sheet.at(k % kColumns * kTile + column, k / kColumns * kTile + row) =
            static_cast<std::uint8_t>(std::lround(255 * grey));
      }
    }
  }
  return sheet;
}

const std::string kGolden = WOBBLEBENCH_GOLDEN "/render_settings.pgm";

Image<std::uint8_t> read_pgm(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string magic;
  int width = 0, height = 0, most = 0;
  in >> magic >> width >> height >> most;
  in.get();
  Image<std::uint8_t> image(width, height);
  in.read(reinterpret_cast<char*>(image.pixels.data()),
          static_cast<std::streamsize>(image.pixels.size()));
  return in ? image : Image<std::uint8_t>();
}

void write_pgm(const std::string& path, const Image<std::uint8_t>& image) {
  std::ofstream out(path, std::ios::binary);
  out << "P5\n" << image.width << " " << image.height << "\n255\n";
  out.write(reinterpret_cast<const char*>(image.pixels.data()),
            static_cast<std::streamsize>(image.pixels.size()));
}

// Detects a common change of GL and reference. After an intended change, WOBBLEBENCH_WRITE_GOLDEN=1
// rewrites the sheet; inspect it.
TEST(GoldenSettings, MatchTheGoldenSheet) {
  if (!testing::gl_context().renderer_string().starts_with("llvmpipe")) {
    GTEST_SKIP() << "the golden sheet is llvmpipe's";
  }
  const Image<std::uint8_t> got = golden_sheet();
  if (std::getenv("WOBBLEBENCH_WRITE_GOLDEN")) write_pgm(kGolden, got);
  const Image<std::uint8_t> golden = read_pgm(kGolden);
  ASSERT_EQ(golden.pixels.size(), got.pixels.size()) << kGolden;
  constexpr int kGreyLevels = 3;  // other drivers' compilers round differently
  for (int k = 0; k < static_cast<int>(std::size(kSettings)); ++k) {
    int failing = 0;
    for (int i = 0; i < 1600; ++i) {
      const int column = k % 8 * 40 + i % 40, row = k / 8 * 40 + i / 40;
      failing += std::abs(golden.at(column, row) - got.at(column, row)) > kGreyLevels;
    }
    EXPECT_LE(failing, kSettings[k].golden_share * 1600) << kSettings[k].name;
  }
}

const auto kNameOfSetting = [](const auto& of) { return std::string(of.param.name); };
INSTANTIATE_TEST_SUITE_P(Bases, EachSetting, ::testing::ValuesIn(kBaseSettings), kNameOfSetting);
INSTANTIATE_TEST_SUITE_P(Settings, EachSetting, ::testing::ValuesIn(kSettings), kNameOfSetting);

hw::PolarVolume scene_named(const std::string& name) {
  const hw::AcquisitionPlan plan = testing::small_plan();
  if (name == "sphere") {
    return testing::sample_field(plan, testing::sphere({0, 0, 0.12}, 0.03, 4e-3));
  }
  if (name == "plane") {
    return testing::sample_field(plan, testing::plane({0, 0, 0.12}, {0.2, 0.1, -1}, 4e-3));
  }
  if (name == "noise") {
    return testing::sample_field(plan,
                                 testing::noisy([](const glm::dvec3&) { return 0.4; }, 0.3, 5));
  }
  return testing::noisy_scene();
}

struct View {
  const char* name;
  double yaw_deg, pitch_deg;
};
void PrintTo(const View& view, std::ostream* out) {
  *out << view.name;
}
const View kViews[] = {
    {"front", 0, 0}, {"right", 40, 0}, {"left_below", -50, -35}, {"above", 0, 60}, {"side", 90, 0}};

class FastAgainstPlain
    : public ::testing::TestWithParam<std::tuple<const char*, View, KernelSpace>> {};

TEST_P(FastAgainstPlain, RendersTheSamePicture) {
  const auto& [scene, view, space] = GetParam();
  const hw::PolarVolume volume = scene_named(scene);
  RenderOptions options = testing::small_options();
  options.view.yaw_rad = view.yaw_deg * kDegree;
  options.view.pitch_rad = view.pitch_deg * kDegree;
  options.ray_casting.kernel_space = space;
  const Picture plain = rendered(volume, options, PipelineMode::plain);
  EXPECT_GT(testing::hits(plain.depth_m), 0);
  expect_same(rendered(volume, options, PipelineMode::fast), plain, {}, options);
}

INSTANTIATE_TEST_SUITE_P(
    Each,
    FastAgainstPlain,
    ::testing::Combine(::testing::Values("sphere", "plane", "noise", "noisy_scene"),
                       ::testing::ValuesIn(kViews),
                       ::testing::Values(KernelSpace::slice, KernelSpace::ray)),
    [](const auto& param_info) {
      const bool slice = std::get<2>(param_info.param) == KernelSpace::slice;
      return std::string(std::get<0>(param_info.param)) + "_" + std::get<1>(param_info.param).name +
             (slice ? "_slice" : "_ray");
    });

/// Settings and views drawn at random.
RenderOptions random_options(std::mt19937& random) {
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto integer = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  RenderOptions options = testing::small_options();
  options.view = {uniform(-kPi, kPi), uniform(-kPi, kPi), uniform(-kPi, kPi)};
  options.view.projection = integer(0, 2) == 0 ? Projection::perspective : Projection::parallel;
  options.view.eye_distance_m = uniform(0.02, 0.5);
  RayCastingOptions& o = options.ray_casting;
  o.image_size = 24;
  o.steps = integer(8, 160);
  o.buffer_length = 2 * integer(1, 12);
  o.threshold = uniform(0.02, 0.4) * o.buffer_length / 2;
  o.kernel_3d = 1 + 2 * integer(0, 2);
  o.window_2d = 1 + 2 * integer(0, 1);
  o.kernel_space = integer(0, 2) == 0 ? KernelSpace::ray : KernelSpace::slice;
  o.edge = integer(0, 1) ? EdgeSign::rising : EdgeSign::falling;
  o.mode = static_cast<RenderMode>(integer(0, 2));
  o.detector = static_cast<Detector>(integer(0, 2));
  o.smallest_piece_m2 = integer(0, 1) * 40e-6;
  o.incidence_correction_m = integer(0, 1) * 1e-3;
  if (integer(0, 2) == 0) o.incidence_correction_m.reset();
  options.reconstruction.sticks = integer(0, 3) == 0 ? Sticks::aligned : Sticks::plain;
  options.reconstruction.spacing_m = 4e-3;
  o.stop_at_box = integer(0, 2) > 0;
  o.stop_on_leaving_cone = integer(0, 1) > 0;
  options.volume_of_interest.center_m = {
      uniform(-0.04, 0.04), uniform(-0.04, 0.04), uniform(0.06, 0.16)};
  options.volume_of_interest.size_m = {uniform(0.02, 0.3), uniform(0.02, 0.3), uniform(0.02, 0.3)};
  options.scan_conversion.slice_size = integer(24, 90);
  options.scan_conversion.filter_size = 1 + 2 * integer(0, 2);
  o.caps = integer(0, 1) > 0;
  return options;
}

/// A driver that ends a pixel's loops after some number of turns must not shorten rays.
RenderOptions options_of_many_taps(int steps, int window) {
  RenderOptions options = testing::small_options();
  options.ray_casting.image_size = 24;
  options.ray_casting.kernel_space = KernelSpace::ray;
  options.ray_casting.kernel_3d = 5;
  options.ray_casting.window_2d = window;
  options.ray_casting.steps = steps;
  options.ray_casting.opacity_limit = 2;
  return options;
}

TEST(ManyTaps, AreTakenToTheEndOfARay) {
  const hw::PolarVolume& volume = testing::noisy_scene();
  const RenderOptions options = options_of_many_taps(1600, 7);
  Picture expected = rendered(volume, options_of_many_taps(1600, 1), PipelineMode::plain);
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    // The window acts on the buffer alone.
    const auto blended =
        testing::compare(rendered(volume, options, mode).volume, expected.volume, 0.005);
    EXPECT_EQ(blended.failing_share, 0) << to_string(mode);
  }
}

TEST(ManyTaps, AreRefusedWhereTheDriverWouldEndRays) {
  if (!testing::gl_context().renderer_string().starts_with("llvmpipe")) GTEST_SKIP();
  const RenderOptions options = options_of_many_taps(4096, 11);
  EXPECT_THROW(rendered(testing::noisy_scene(), options, PipelineMode::plain), std::runtime_error);
  EXPECT_THROW(rendered(testing::noisy_scene(), options, PipelineMode::fast), std::runtime_error);
}

TEST(FastAgainstPlainAtRandom, RendersTheSamePicture) {
  std::mt19937 random(11);
  const hw::PolarVolume& volume = testing::noisy_scene();
  // Up to two pixels of 576 may differ by float rounding, on rays that graze a border; their
  // neighbours are shaded by them.
  const Bounds two{.changed_share = 2.5 / 576, .blended_share = 2.5 / 576, .surface_share = 1};
  int compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    const RenderOptions options = random_options(random);
    compared += expect_same(rendered(volume, options, PipelineMode::fast),
                            rendered(volume, options, PipelineMode::plain),
                            two,
                            options);
  }
  EXPECT_GT(compared, 1200);
}

}  // namespace
}  // namespace wobblebench::render
