// Whole pictures: mode fast against mode plain for scenes, views and settings drawn at random.
#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

#include "base/units.h"
#include "render/camera.h"
#include "tests/render/support/agreement.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

std::vector<hw::PolarVolume> scenes() {
  const hw::AcquisitionPlan plan = testing::small_plan();
  const auto scene = [&](const testing::Field& field) {
    return testing::sample_field(plan, field);
  };
  return {testing::noisy_scene(),
          scene(testing::sphere({0, 0, 0.12}, 0.03, 4e-3)),
          scene(testing::plane({0, 0, 0.12}, {0.2, 0.1, -1}, 4e-3)),
          scene(testing::noisy([](const glm::dvec3&) { return 0.4; }, 0.3, 5))};
}

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
  if (integer(0, 1)) o.iso_level.reset();
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
  o.outline_m = integer(0, 1) * 4e-3;
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
  Picture expected = testing::rendered(volume, options_of_many_taps(1600, 1), PipelineMode::plain);
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    // The window acts on the buffer alone.
    const auto blended =
        testing::compare(testing::rendered(volume, options, mode).volume, expected.volume, 0.005);
    EXPECT_EQ(blended.failing_share, 0) << to_string(mode);
  }
}

TEST(ManyTaps, AreRefusedWhereTheDriverWouldEndRays) {
  if (!testing::gl_context().renderer_string().starts_with("llvmpipe")) GTEST_SKIP();
  const RenderOptions options = options_of_many_taps(4096, 11);
  EXPECT_THROW(testing::rendered(testing::noisy_scene(), options, PipelineMode::plain),
               std::runtime_error);
  EXPECT_THROW(testing::rendered(testing::noisy_scene(), options, PipelineMode::fast),
               std::runtime_error);
}

TEST(FastAgainstPlainAtRandom, RendersTheSamePicture) {
  std::mt19937 random(11);
  const std::vector<hw::PolarVolume> volumes = scenes();
  // Up to two pixels of 576 may differ by float rounding, on rays that graze a border; their
  // neighbours are shaded by them.
  testing::Bounds two{.changed_share = 2.5 / 576, .blended_share = 2.5 / 576};
  int compared = 0, same = 0;
  for (int trial = 0; trial < 40; ++trial) {
    SCOPED_TRACE(trial);
    const RenderOptions options = random_options(random);
    const hw::PolarVolume& volume = volumes[random() % volumes.size()];
    const Picture fast = testing::rendered(volume, options, PipelineMode::fast);
    const Picture plain = testing::rendered(volume, options, PipelineMode::plain);
    const auto depth = testing::compare(fast.depth_m, plain.depth_m);
    const bool is_same = depth.changed_share == 0 && depth.largest_m < 0.1 * step_m(options);
    two.surface_share = is_same ? testing::Bounds().surface_share : 1;
    same += is_same;
    compared += testing::expect_same(fast, plain, two, options);
  }
  EXPECT_GT(compared, 800);
  EXPECT_GT(same, 26);
}

}  // namespace
}  // namespace wobblebench::render
