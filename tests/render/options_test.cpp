#include "render/options.h"

#include <gtest/gtest.h>

#include "render/geometry/ray_sampling.h"

namespace wobblebench::render {
namespace {

TEST(RenderOptions, DefaultsAreValid) {
  EXPECT_NO_THROW(validate(RenderOptions{}));
}

struct Refusal {
  const char* name;
  void (*change)(RenderOptions&);
  const char* message;
};

class RenderOptionsRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(RenderOptionsRefusal, NamesKeyValueAndWhatIsAllowed) {
  RenderOptions options;
  GetParam().change(options);
  try {
    validate(options);
    FAIL() << "accepted";
  } catch (const InvalidOption& refusal) {
    EXPECT_STREQ(refusal.what(), GetParam().message);
  }
}

const Refusal kRefusals[] = {
    {"slice_size",
     [](RenderOptions& o) { o.scan_conversion.slice_size = 8; },
     "scan_conversion.slice_size = 8: must be within 16 and 2048"},
    {"filter_size",
     [](RenderOptions& o) { o.scan_conversion.filter_size = 4; },
     "scan_conversion.filter_size = 4: must be odd"},
    {"box_size",
     [](RenderOptions& o) {
       o.volume_of_interest.size_m = {0.1, 0.1, 0};
     },
     "volume_of_interest.size_mm = 0: must be within 1 and 1000"},
    {"kernel_3d",
     [](RenderOptions& o) { o.ray_casting.kernel_3d = 4; },
     "ray_casting.kernel_3d = 4: must be odd"},
    {"buffer_length",
     [](RenderOptions& o) { o.ray_casting.buffer_length = 7; },
     "ray_casting.buffer_length = 7: must be even"},
    {"both_buffer_lengths",
     [](RenderOptions& o) {
       o.ray_casting.buffer_length = 16;
       o.ray_casting.buffer_length_m = 4e-3;
     },
     "ray_casting.buffer_length_mm = 4: cannot be given with buffer_length"},
    {"buffer_length_too_long",  // 66 steps of 80 mm / 512
     [](RenderOptions& o) { o.ray_casting.buffer_length_m = 10.3e-3; },
     "ray_casting.buffer_length_mm = 10.3: must be 2 to 64 steps of 0.156 mm"},
    {"buffer_length_too_short",
     [](RenderOptions& o) { o.ray_casting.buffer_length_m = 0.1e-3; },
     "ray_casting.buffer_length_mm = 0.1: must be 2 to 64 steps of 0.156 mm"},
    {"window_2d",
     [](RenderOptions& o) { o.ray_casting.window_2d = 2; },
     "ray_casting.window_2d = 2: must be odd"},
    {"threshold",
     [](RenderOptions& o) { o.ray_casting.threshold = std::nan(""); },
     "ray_casting.threshold = nan: must be within -64 and 64"},
    {"two_thresholds",
     [](RenderOptions& o) {
       o.ray_casting.threshold = 0.2;
       o.ray_casting.threshold_per_sample = 0.05;
     },
     "ray_casting.threshold_per_sample = 0.05: cannot be given with threshold"},
    {"rendered_base_without_a_picture",
     [](RenderOptions& o) {
       o.shading.base = ShadingBase::rendered;
       o.ray_casting.mode = RenderMode::surface;
     },
     "shading.base = rendered: needs ray_casting.mode both; surface blends no picture"},
    {"transfer_order",
     [](RenderOptions& o) {
       o.ray_casting.transfer_values = {0, 0.5, 0.5, 1};
     },
     "ray_casting.transfer_values = 4 numbers: must ascend"},
    {"transfer_length",
     [](RenderOptions& o) {
       o.ray_casting.transfer_grey = {0, 1};
     },
     "ray_casting.transfer_grey = 2 numbers: takes as many as transfer_values, 4 numbers"},
    {"transfer_too_short",
     [](RenderOptions& o) { o.ray_casting.transfer_values = {0}; },
     "ray_casting.transfer_values = 1 numbers: takes at least 2"},
    {"depth_filter_size",
     [](RenderOptions& o) { o.shading.depth_filter_size = 6; },
     "shading.depth_filter_size = 6: must be odd"},
    {"base_rgb",
     [](RenderOptions& o) {
       o.shading.base_rgb = {1, 1, 2};
     },
     "shading.base_rgb = 2: must be within 0 and 1"},
    {"smoothing",
     [](RenderOptions& o) { o.smoothing.filter_size = 16; },
     "smoothing.filter_size = 16: must be within 1 and 15"},
    {"view",
     [](RenderOptions& o) { o.view.eye_distance_m = 0; },
     "view.eye_distance_mm = 0: must be within 1 and 10000"},
};

INSTANTIATE_TEST_SUITE_P(Each,
                         RenderOptionsRefusal,
                         ::testing::ValuesIn(kRefusals),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(RenderOptions, ABufferOfMillimetresIsTheNearestEvenNumberOfSteps) {
  RenderOptions options;  // 512 steps in 80 mm
  EXPECT_EQ(buffer_samples(options), 8);
  options.ray_casting.buffer_length_m = 10e-3;
  EXPECT_EQ(buffer_samples(options), 64);
  options.ray_casting.buffer_length_m = 1.1e-3;  // 7.04 steps
  EXPECT_EQ(buffer_samples(options), 8);
  options.ray_casting.steps = 1024;
  EXPECT_EQ(buffer_samples(options), 14);
  EXPECT_NO_THROW(validate(options));
}

TEST(RenderOptions, AlignedSticksNeedWholeVolumes) {
  RenderOptions options;
  options.pipeline.mid_volume = true;
  EXPECT_NO_THROW(validate(options));
  options.reconstruction.sticks = Sticks::aligned;
  EXPECT_THROW(validate(options), InvalidOption);
  options.pipeline.mid_volume = false;
  EXPECT_NO_THROW(validate(options));
}

}  // namespace
}  // namespace wobblebench::render
