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
#include "tests/render/support/settings.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

struct Setting {
  const char* name;
  const char* settings;
  double z_rms_steps = 0.02;
  double changed_share = 0.001;
  double blended_share = 0.002;
  double golden_share = 0.01;  ///< of pixels more than 3 grey levels off in the golden sheet
};
void PrintTo(const Setting& setting, std::ostream* out) {
  *out << setting.name;
}

class Agreement : public ::testing::TestWithParam<Setting> {};

TEST_P(Agreement, WithTheReferenceInBothModes) {
  RenderOptions options = testing::small_options();
  const Setting& setting = GetParam();
  testing::set(options, setting.settings);
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
    {"defaults", ""},
    {"kernel_none", "ray_casting.kernel_3d=1"},
    {"kernel_5", "ray_casting.kernel_3d=5"},
    {"ray_kernel_3", "ray_casting.kernel_space=ray"},
    {"ray_kernel_5", "ray_casting.kernel_space=ray ray_casting.kernel_3d=5"},
    {"buffer_2", "ray_casting.buffer_length=2 ray_casting.threshold=0.12"},
    {"buffer_16", "ray_casting.buffer_length=16 ray_casting.threshold=2"},
    {"buffer_64", "ray_casting.buffer_length=64 ray_casting.threshold=4"},
    // In noise Difference crosses 0 slowly, so rounding decides where.
    {"threshold_zero", "ray_casting.threshold=0", 0.5},
    {"threshold_negative", "ray_casting.threshold=-1"},
    {"edge_falling", "ray_casting.edge=falling ray_casting.mode=surface"},
    {"window_3", "ray_casting.window_2d=3"},
    {"window_5_without_kernel", "ray_casting.window_2d=5 ray_casting.kernel_3d=1"},
    // One pixel of 1600 that is detected a step apart is 0.025 steps RMS.
    {"unrefined_crossing", "ray_casting.refine_crossing=false", 0.05},
    {"goes_on_beyond_the_box", "ray_casting.stop_at_box=false"},
    {"goes_on_beyond_the_cone", "ray_casting.stop_on_leaving_cone=false view.yaw_deg=70"},
    {"early_opaque", "ray_casting.opacity_limit=0.3"},
    {"never_opaque", "ray_casting.opacity_limit=2"},
    {"transfer_function",
     "ray_casting.transfer_values=0.1,0.4,0.9 ray_casting.transfer_opacity_per_mm=0,0.9,0.1 "
     "ray_casting.transfer_grey=1,0.2,0.7"},
    {"mode_surface", "ray_casting.mode=surface"},
    {"mode_volume", "ray_casting.mode=volume"},
    {"few_steps", "ray_casting.steps=16 ray_casting.buffer_length=2 ray_casting.threshold=0.2"},
    {"format_r32f", "scan_conversion.format=r32f"},
    // 8-bit samples and 8-bit filter weights change Difference and z: the bounds show by how much,
    // and why r8 is not the default.
    {"format_r8", "scan_conversion.format=r8", 1.5, 0.01, 0.02},
    {"slice_filter_none", "scan_conversion.filter_size=1"},
    {"slice_filter_7", "scan_conversion.filter_size=7"},
    {"odd_slice_size", "scan_conversion.slice_size=101"},
    {"perspective", "view.projection=perspective"},
    // At ray lengths of 10 m float resolves 1e-6 m, a thousandth of a step here.
    {"perspective_from_afar", "view.projection=perspective view.eye_distance_mm=10000"},
    {"perspective_eye_inside", "view.projection=perspective view.eye_distance_mm=30"},
    {"view_from_the_right", "view.yaw_deg=40"},
    {"view_from_above", "view.pitch_deg=35"},
    {"view_from_below_left", "view.yaw_deg=-28.6479 view.pitch_deg=-22.9183 view.roll_deg=17.1887"},
    {"view_along_x", "view.yaw_deg=90"},
    {"view_from_behind", "view.yaw_deg=170 view.projection=perspective"},
    {"light_directional", "shading.light=directional"},
    {"light_left", "shading.light_left_deg=45"},
    {"no_shadows", "shading.shadows=false"},
    {"depth_filter_none", "shading.depth_filter_size=1"},
    {"smoothing_low", "smoothing.filter_size=5"},
    {"smoothing_bilateral", "smoothing.filter=bilateral"},
    {"smoothing_guided", "smoothing.filter=guided"},
    {"box_partly_outside_the_cone",
     "volume_of_interest.center_mm=50,30,130 volume_of_interest.size_mm=200,200,160"},
};

/// Beside the golden sheet. `paper`: every step as the paper writes it
/// (docs/decisions/0006-defaults-of-the-probe.md).
const Setting kBaseSettings[] = {
    {"base_rendered", "shading.base=rendered"},
    {"paper",
     "ray_casting.kernel_space=ray ray_casting.refine_crossing=false shading.base=rendered "
     "shading.base_rgb=1,1,1",
     0.05},
    {"buffer_of_millimetres", "ray_casting.buffer_length_mm=25 ray_casting.threshold=2"},
    {"buffer_30",  // no multiple of a block
     "ray_casting.buffer_length=30 ray_casting.threshold=3"},
    {"buffer_64_beyond_the_cone",
     "ray_casting.buffer_length=64 ray_casting.threshold=4 ray_casting.stop_on_leaving_cone=false "
     "view.yaw_deg=70"},
    {"buffer_64_of_a_ray_kernel",
     "ray_casting.buffer_length=64 ray_casting.threshold=4 ray_casting.kernel_space=ray"},
    {"detector_iso", "ray_casting.detector=iso"},
    {"detector_iso_falling",
     "ray_casting.detector=iso ray_casting.edge=falling ray_casting.mode=surface"},
    {"detector_iso_in_rays", "ray_casting.detector=iso ray_casting.kernel_space=ray"},
    {"detector_floor", "ray_casting.detector=floor"},
    {"detector_floor_of_surfaces_alone",  // leaps farther: nothing is blended
     "ray_casting.detector=floor ray_casting.mode=surface"},
    {"detector_floor_falling",
     "ray_casting.detector=floor ray_casting.edge=falling ray_casting.mode=surface"},
    {"detector_floor_beyond_the_cone",
     "ray_casting.detector=floor ray_casting.stop_on_leaving_cone=false view.yaw_deg=70"},
    {"detector_floor_of_a_ray_kernel", "ray_casting.detector=floor ray_casting.kernel_space=ray"},
    {"sticks_aligned", "reconstruction.sticks=aligned"},
    {"sticks_aligned_iso",
     "reconstruction.sticks=aligned ray_casting.detector=iso ray_casting.iso_level=auto"},
    {"incidence_corrected", "ray_casting.incidence_correction_mm=1 view.yaw_deg=23"},
    {"incidence_corrected_in_perspective",
     "ray_casting.incidence_correction_mm=1 view.projection=perspective"},
    {"small_pieces_left_out", "ray_casting.smallest_piece_mm2=50"},
    {"incidence_corrected_by_the_beam", "ray_casting.incidence_correction_mm=auto view.yaw_deg=23"},
    {"outline_smoothed", "ray_casting.outline_mm=4"},
    {"caps_on_a_scan_that_begins_in_tissue",
     "ray_casting.detector=iso ray_casting.caps=true view.yaw_deg=80"},
};

/// All settings' shaded pictures side by side, as 8-bit grey.
Image<std::uint8_t> golden_sheet() {
  constexpr int kTile = 40, kColumns = 8;
  const int count = static_cast<int>(std::size(kSettings));
  Image<std::uint8_t> sheet(kColumns * kTile, (count + kColumns - 1) / kColumns * kTile);
  for (int k = 0; k < count; ++k) {
    RenderOptions options = testing::small_options();
    testing::set(options, kSettings[k].settings);
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
INSTANTIATE_TEST_SUITE_P(OtherSettings,
                         Agreement,
                         ::testing::ValuesIn(kBaseSettings),
                         kNameOfSetting);
INSTANTIATE_TEST_SUITE_P(GoldenSettings, Agreement, ::testing::ValuesIn(kSettings), kNameOfSetting);

}  // namespace
}  // namespace wobblebench::render
