// Mode fast renders the picture of mode plain, within bounds, for several scenes and views.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <tuple>

#include "render/camera.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

constexpr double kZRmsSteps = 0.1;
constexpr double kChangedShare = 0.001;

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
  options.pipeline.mode = PipelineMode::plain;
  const Picture plain = render_volume(testing::gl_context(), volume, options);
  options.pipeline.mode = PipelineMode::fast;
  const Picture fast = render_volume(testing::gl_context(), volume, options);

  EXPECT_GT(testing::hits(plain.depth_m), 0);
  const auto depth = testing::compare(fast.depth_m, plain.depth_m);
  EXPECT_LE(depth.rms_m, kZRmsSteps * step_m(options));
  EXPECT_LE(depth.changed_share, kChangedShare);
  EXPECT_LE(testing::compare(fast.volume, plain.volume, 0.005).failing_share, 0.005);
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
  o.incidence_correction_m = integer(0, 1) * 1e-3;
  options.reconstruction.sticks = integer(0, 3) == 0 ? Sticks::aligned : Sticks::plain;
  options.reconstruction.spacing_m = 4e-3;
  o.stop_at_box = integer(0, 2) > 0;
  o.stop_on_leaving_cone = integer(0, 1) > 0;
  options.volume_of_interest.center_m = {
      uniform(-0.04, 0.04), uniform(-0.04, 0.04), uniform(0.06, 0.16)};
  options.volume_of_interest.size_m = {uniform(0.02, 0.3), uniform(0.02, 0.3), uniform(0.02, 0.3)};
  options.scan_conversion.slice_size = integer(24, 90);
  options.scan_conversion.filter_size = 1 + 2 * integer(0, 2);
  return options;
}

TEST(FastAgainstPlainAtRandom, RendersTheSamePicture) {
  std::mt19937 random(11);
  int compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    SCOPED_TRACE(trial);
    RenderOptions options = random_options(random);
    const hw::PolarVolume& volume = testing::noisy_scene();
    options.pipeline.mode = PipelineMode::plain;
    const Picture plain = render_volume(testing::gl_context(), volume, options);
    options.pipeline.mode = PipelineMode::fast;
    const Picture fast = render_volume(testing::gl_context(), volume, options);
    // Up to two pixels of 576 may differ by float rounding, on rays that graze a border.
    const auto depth = testing::compare(fast.depth_m, plain.depth_m);
    EXPECT_LE(depth.changed_share, 2.5 / 576);
    EXPECT_LE(depth.rms_m, kZRmsSteps * step_m(options));
    EXPECT_LE(testing::compare(fast.volume, plain.volume, 0.005).failing_share, 2.5 / 576);
    compared += depth.both;
  }
  EXPECT_GT(compared, 1500);
}

}  // namespace
}  // namespace wobblebench::render
