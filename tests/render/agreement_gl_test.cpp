// Whole pictures: both modes of the GL pipeline against the double-precision reference, with each
// setting changed once.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <ostream>
#include <string>

#include "render/camera.h"
#include "render/reference/reference.h"
#include "render/renderer.h"
#include "tests/render/support/agreement.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

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
  const testing::Bounds bounds{setting.z_rms_steps, setting.changed_share, setting.blended_share};
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    SCOPED_TRACE(mode == PipelineMode::fast ? "fast" : "plain");
    testing::expect_same(testing::rendered(volume, options, mode), expected, bounds, options);
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
    {"caps_on_a_box_that_begins_in_tissue",
     [](RenderOptions& o) {
       o.ray_casting.detector = Detector::iso;
       o.ray_casting.caps = true;
       o.volume_of_interest.center_m.z += 0.02;
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

}  // namespace
}  // namespace wobblebench::render
