#include "render/options.h"

#include <gtest/gtest.h>

#include <utility>

#include "render/geometry/ray_sampling.h"
#include "tests/render/support/settings.h"
#include "tests/support/expect.h"

namespace wobblebench::render {
namespace {

TEST(RenderOptions, DefaultsAreValid) {
  EXPECT_NO_THROW(validate(RenderOptions{}));
}

TEST(RenderOptions, RefusalsNameKeyValueAndWhatIsAllowed) {
  const std::pair<const char*, const char*> refused[] = {
      {"scan_conversion.slice_size=8",
       "scan_conversion.slice_size = 8: must be within 16 and 2048"},
      {"scan_conversion.filter_size=4", "scan_conversion.filter_size = 4: must be odd"},
      {"volume_of_interest.size_mm=100,100,0",
       "volume_of_interest.size_mm = 0: must be within 1 and 1000"},
      {"ray_casting.kernel_3d=4", "ray_casting.kernel_3d = 4: must be odd"},
      {"ray_casting.buffer_length=7", "ray_casting.buffer_length = 7: must be even"},
      {"ray_casting.buffer_length=16 ray_casting.buffer_length_mm=4",
       "ray_casting.buffer_length_mm = 4: cannot be given with buffer_length"},
      {"ray_casting.buffer_length_mm=10.3",
       "ray_casting.buffer_length_mm = 10.3: must be 2 to 64 steps of 0.156 mm"},
      {"ray_casting.buffer_length_mm=0.1",
       "ray_casting.buffer_length_mm = 0.1: must be 2 to 64 steps of 0.156 mm"},
      {"ray_casting.window_2d=2", "ray_casting.window_2d = 2: must be odd"},
      {"ray_casting.threshold=nan", "ray_casting.threshold = nan: must be within -64 and 64"},
      {"ray_casting.threshold=0.2 ray_casting.threshold_per_sample=0.05",
       "ray_casting.threshold_per_sample = 0.05: cannot be given with threshold"},
      {"shading.base=rendered ray_casting.mode=surface",
       "shading.base = rendered: needs ray_casting.mode both; surface blends no picture"},
      {"ray_casting.transfer_values=0,0.5,0.5,1",
       "ray_casting.transfer_values = 4 numbers: must ascend"},
      {"ray_casting.transfer_grey=0,1",
       "ray_casting.transfer_grey = 2 numbers: takes as many as transfer_values, 4 numbers"},
      {"ray_casting.transfer_values=0",
       "ray_casting.transfer_values = 1 numbers: takes at least 2"},
      {"shading.depth_filter_size=6", "shading.depth_filter_size = 6: must be odd"},
      {"shading.base_rgb=1,1,2", "shading.base_rgb = 2: must be within 0 and 1"},
      {"smoothing.filter_size=16", "smoothing.filter_size = 16: must be within 1 and 15"},
      {"view.eye_distance_mm=0", "view.eye_distance_mm = 0: must be within 1 and 10000"},
  };
  for (const auto& [settings, message] : refused) {
    RenderOptions options;
    testing::set(options, settings);
    EXPECT_EQ(refusal_of<InvalidOption>([&] { validate(options); }), message);
  }
}

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
