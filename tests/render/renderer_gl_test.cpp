// Contract of the renderer beyond agreement with the reference.
#include "render/renderer.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <limits>

#include "render/camera.h"
#include "render/geometry/slice_geometry.h"
#include "render/reference/reference.h"
#include "tests/render/support/agreement.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"
#include "tests/support/expect.h"

namespace wobblebench::render {
namespace {

using testing::gl_context;
using testing::hits;
using testing::same_bits;

TEST(Renderer, RepeatsBitForBit) {
  const RenderOptions options = testing::small_options();
  const Picture one = render_volume(gl_context(), testing::noisy_scene(), options);
  const Picture two = render_volume(gl_context(), testing::noisy_scene(), options);
  testing::expect_same_bits(one, two);
}

TEST(Renderer, CompilingChangesNoPicture) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    for (const bool mid_volume : {false, true}) {
      RenderOptions options = testing::small_options();
      options.pipeline = {mode, mid_volume};
      Renderer cold(gl_context(), scene.plan(), options), warm(gl_context(), scene.plan(), options);
      warm.compile();
      EXPECT_EQ(warm.render().passes.front().ms, 0);  // not counted
      EXPECT_EQ(hits(warm.render().depth_m), 0);
      for (int frame : {10, 11, 9}) {
        cold.add_frame(frame, scene.frame(frame));
        warm.add_frame(frame, scene.frame(frame));
      }
      EXPECT_TRUE(same_bits(warm.render().depth_m, cold.render().depth_m));
      cold.add_volume(scene);
      warm.add_volume(scene);
      testing::expect_same_bits(warm.render(), cold.render());
    }
  }
}

TEST(Renderer, IsCompiledInTheBackground) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  const RenderOptions options = testing::small_options();
  const Picture expected = render_volume(gl_context(), scene, options);
  Renderer renderer(gl_context(), scene.plan(), options);
  renderer.add_volume(scene);
  const auto never = std::make_unique<Renderer>(gl_context(), scene.plan(), options);
  static_cast<void>(never->compile_in_background());  // waits
  Renderer compiled(gl_context(), scene.plan(), options);
  auto done = compiled.compile_in_background();
  done.get();
  compiled.add_volume(scene);
  EXPECT_TRUE(same_bits(compiled.render().depth_m, expected.depth_m));
  EXPECT_TRUE(same_bits(renderer.render().depth_m, expected.depth_m));
}

TEST(Renderer, RefusesLinearEnvelopes) {
  const hw::AcquisitionPlan plan = testing::small_plan();
  hw::PolarVolume linear(plan);
  hw::Stick stick;
  stick.samples.resize(static_cast<std::size_t>(plan.acquisition().samples_per_stick));
  stick.scale = hw::SampleScale::linear_envelope;
  linear.place(stick);
  EXPECT_THROW(render_volume(gl_context(), linear, testing::small_options()),
               std::invalid_argument);
  EXPECT_THROW(render_reference(linear, testing::small_options()), std::invalid_argument);
  linear.log_compress(60);
  EXPECT_NO_THROW(render_volume(gl_context(), linear, testing::small_options()));
}

TEST(Renderer, AcceptsFramesInAnyOrder) {
  const hw::PolarVolume& volume = testing::noisy_scene();
  const RenderOptions options = testing::small_options();
  Renderer renderer(gl_context(), volume.plan(), options);
  for (int frame = volume.plan().acquisition().frames_per_volume - 1; frame >= 0; --frame) {
    renderer.add_frame(frame, volume.frame(frame));
  }
  const Picture backwards = renderer.render();
  EXPECT_TRUE(same_bits(backwards.depth_m, render_volume(gl_context(), volume, options).depth_m));
}

TEST(Renderer, ShowsTheLastCompleteVolume) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  const auto blank =
      testing::sample_field(testing::small_plan(), [](const glm::dvec3&) { return 0.0; });
  for (PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    RenderOptions options = testing::small_options();
    options.pipeline.mode = mode;
    const Picture expected = render_volume(gl_context(), scene, options);
    Renderer renderer(gl_context(), scene.plan(), options);
    const auto add = [&](const hw::PolarVolume& volume, int first, int last) {
      for (int f = first; f <= last; ++f) {
        renderer.add_frame(f, volume.frame(f));
        renderer.update();
      }
    };
    add(scene, 0, 19);
    EXPECT_EQ(hits(renderer.render().depth_m), 0);  // none is complete yet
    add(scene, 20, 20);
    EXPECT_TRUE(same_bits(renderer.render().depth_m, expected.depth_m));
    add(blank, 0, 19);
    EXPECT_TRUE(same_bits(renderer.render().depth_m, expected.depth_m));
    add(blank, 20, 20);
    EXPECT_EQ(hits(renderer.render().depth_m), 0);
  }
}

TEST(Renderer, MidVolumeShowsFramesAsTheyArrive) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  for (PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    RenderOptions options = testing::small_options();
    options.pipeline = {mode, true};
    Renderer renderer(gl_context(), scene.plan(), options);
    int before = 0;
    for (int f : {10, 11, 9, 12, 8}) {
      renderer.add_frame(f, scene.frame(f));
      const int now = hits(renderer.render().depth_m);
      EXPECT_GT(now, before) << "frame " << f;
      before = now;
    }
    for (int f = 0; f < 21; ++f) renderer.add_frame(f, scene.frame(f));
    EXPECT_TRUE(
        same_bits(renderer.render().depth_m, render_volume(gl_context(), scene, options).depth_m));
  }
}

/// Two planes across the probe's axis, of which the later one is deeper: a pixel shows that of the
/// volume whose frames lie where it looks, but within two frames of the edge.
TEST(Renderer, MidVolumeShowsNewFramesBesideThoseOfTheVolumeBefore) {
  constexpr int kNew = 10;  // of 21
  const hw::AcquisitionPlan plan = testing::small_plan();
  const auto plane_at = [&](double z_m) {
    return testing::sample_field(plan, testing::plane({0, 0, z_m}, {0, 0, -1}, 4e-3));
  };
  const hw::PolarVolume before = plane_at(0.105), now = plane_at(0.125);
  const auto angle_of = [&](int frame) {
    return plan.motor_angle_rad({.frame = static_cast<std::uint32_t>(frame)});
  };
  for (const PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    RenderOptions options = testing::small_options();
    options.pipeline = {mode, true};
    Renderer renderer(gl_context(), plan, options);
    renderer.add_volume(before);
    renderer.render();
    for (int frame = 0; frame < kNew; ++frame) renderer.add_frame(frame, now.frame(frame));
    const Picture picture = renderer.render();
    int shown_now = 0, shown_before = 0;
    for (int row = 0; row < options.ray_casting.image_size; ++row) {
      for (int column = 0; column < options.ray_casting.image_size; ++column) {
        const double depth_m = picture.depth_m.at(column, row);
        const glm::dvec3 at = make_camera(options).ray(column, row).at(depth_m);
        const bool is_inside = std::abs(at.y) < 0.045;  // beyond it the fan cuts the planes
        if (std::isnan(depth_m) || !is_inside) continue;
        const double angle = std::atan2(-at.y, at.z - plan.geometry().axis_z_m());
        const bool is_now = angle < angle_of(kNew - 2);
        const bool is_before = angle > angle_of(kNew + 1);
        // A soft edge is found up to its width, 4 mm, too early.
        EXPECT_TRUE(!is_now || std::abs(at.z - 0.123) < 4e-3) << row << ": " << at.z;
        EXPECT_TRUE(!is_before || std::abs(at.z - 0.103) < 4e-3) << row << ": " << at.z;
        shown_now += is_now;
        shown_before += is_before;
      }
    }
    EXPECT_GT(shown_now, 300);
    EXPECT_GT(shown_before, 300);
  }
}

TEST(Renderer, SetViewGivesThePictureOfANewRenderer) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  for (PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    RenderOptions options = testing::small_options();
    options.pipeline.mode = mode;
    Renderer renderer(gl_context(), scene.plan(), options);
    for (int f = 0; f < 21; ++f) renderer.add_frame(f, scene.frame(f));
    renderer.render();
    options.view.yaw_rad = 35 * kDegree;
    options.view.pitch_rad = -20 * kDegree;
    renderer.set_view(options.view);
    EXPECT_TRUE(
        same_bits(renderer.render().depth_m, render_volume(gl_context(), scene, options).depth_m));
  }
}

/// Largest difference of `picture` from `mirrored` read from right to left.
template <class Pixel, class Distance>
double most_beside_mirror(const Image<Pixel>& picture,
                          const Image<Pixel>& mirrored,
                          const Distance& distance) {
  double most = 0;
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const auto& one = picture.at(column, row);
      const auto& other = mirrored.at(picture.width - 1 - column, row);
      most = std::max(most, distance(one, other));
    }
  }
  return most;
}

TEST(Renderer, AFlippedPictureIsTheMirrorImageUnderALightFromTheSameSideOfTheViewer) {
  const hw::PolarVolume& scene = testing::noisy_scene();
  for (const Projection projection : {Projection::parallel, Projection::perspective}) {
    RenderOptions options = testing::small_options();
    options.view.yaw_rad = 20 * kDegree;
    options.view.roll_rad = 10 * kDegree;
    options.view.projection = projection;
    options.ray_casting.incidence_correction_m = 1e-3;
    options.shading.light_left_rad = 30 * kDegree;
    const Picture picture = render_volume(gl_context(), scene, options);
    options.view.flip = true;
    options.shading.light_left_rad = -30 * kDegree;
    const Picture flipped = render_volume(gl_context(), scene, options);
    const auto lengths = [](float one, float other) {
      return std::isfinite(one) || std::isfinite(other) ? std::abs(double(one) - double(other)) : 0;
    };
    const auto colours = [](const glm::vec3& one, const glm::vec3& other) {
      return static_cast<double>(glm::length(one - other));
    };
    EXPECT_LT(most_beside_mirror(flipped.depth_m, picture.depth_m, lengths), 1e-5);
    EXPECT_LT(most_beside_mirror(flipped.volume, picture.volume, colours), 1e-3);
    EXPECT_LT(most_beside_mirror(flipped.surface, picture.surface, colours), 0.01);
    EXPECT_GT(most_beside_mirror(picture.depth_m, picture.depth_m, lengths), 1e-3)
        << "the scene is its own mirror image, and shows nothing";
  }
}

/// A plane across the fan, scanned by a motor that turns within each frame, in both directions.
TEST(Renderer, PlacesSticksOfATurningMotorAtTheirAngles) {
  hw::AcquisitionOptions acquisition = testing::small_plan().acquisition();
  acquisition.frames_per_volume = 11;  // coarse: half a millimetre per stick within a frame
  const auto field = testing::plane({0, 0, 0.12}, {0, 0.5, -1}, 6e-3);
  const auto rms_m = [&](hw::MotorMode motor, std::uint32_t volume_index, PipelineMode mode) {
    acquisition.motor = motor;
    const hw::AcquisitionPlan plan({}, acquisition);
    const hw::PolarVolume volume = testing::sample_field(plan, field, volume_index);
    RenderOptions options = testing::small_options();
    options.pipeline.mode = mode;
    options.volume_of_interest.size_m = {0.06, 0.04, 0.05};
    const Picture got = render_volume(gl_context(), volume, options);
    const Picture expected = render_reference(volume, options);
    EXPECT_GT(hits(got.depth_m), 1000);
    const auto difference = testing::compare(got.depth_m, expected.depth_m);
    EXPECT_LE(difference.rms_m, 0.03 * step_m(options));
    EXPECT_LE(difference.changed_share, 0.002);
    // The plane is tilted about x only, so z is constant along a row.
    double sum = 0;
    int count = 0;
    for (int row = 4; row < 36; ++row) {
      const double middle = got.depth_m.at(20, row);
      for (int column = 2; column < 38; ++column) {
        const double z = got.depth_m.at(column, row);
        if (std::isnan(z) || std::isnan(middle)) continue;
        sum += (z - middle) * (z - middle);
        ++count;
      }
    }
    return std::sqrt(sum / count);
  };
  for (PipelineMode mode : {PipelineMode::fast, PipelineMode::plain}) {
    // If frames of a turning motor were taken as planes, the error would be up to half of 6.1
    // degrees at 0.1 m from the axis, on a slope of 1/2: 1.5 mm RMS.
    EXPECT_LT(rms_m(hw::MotorMode::stepped, 0, mode), 0.1e-3);
    EXPECT_LT(rms_m(hw::MotorMode::continuous, 0, mode), 0.2e-3);
    EXPECT_LT(rms_m(hw::MotorMode::alternating, 1, mode), 0.2e-3);
  }
}

TEST(Renderer, NamesFourPassesWithTheirTimes) {
  const hw::PolarVolume& volume = testing::noisy_scene();
  Renderer renderer(gl_context(), volume.plan(), testing::small_options());
  for (int frame = 0; frame < 21; ++frame) renderer.add_frame(frame, volume.frame(frame));
  const Picture picture = renderer.render();
  ASSERT_EQ(picture.passes.size(), 4u);
  const char* names[] = {"scan_conversion", "ray_casting", "surface_shading", "smoothing"};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(picture.passes[i].name, names[i]);
    EXPECT_GT(picture.passes[i].ms, 0);
    EXPECT_GE(picture.passes[i].gpu_ms, 0);
    EXPECT_LE(picture.passes[i].gpu_ms, picture.passes[i].ms + 1);
  }
  EXPECT_EQ(renderer.render().passes[0].ms, 0);  // no frame since the last picture
}

TEST(Renderer, BothModeEqualsSurfaceModeAndVolumeMode) {
  RenderOptions options = testing::small_options();
  options.ray_casting.opacity_limit = 0.3;  // opaque before some surfaces are found
  const auto in_mode = [&](RenderMode mode) {
    options.ray_casting.mode = mode;
    return render_volume(gl_context(), testing::noisy_scene(), options);
  };
  const Picture both = in_mode(RenderMode::both);
  EXPECT_EQ(testing::compare(both.depth_m, in_mode(RenderMode::surface).depth_m).changed_share, 0);
  EXPECT_LT(testing::compare(both.depth_m, in_mode(RenderMode::surface).depth_m).largest_m, 1e-6);
  EXPECT_LT(testing::compare(both.volume, in_mode(RenderMode::volume).volume, 0).largest, 1e-5);
}

TEST(Renderer, BlankDataHasNoSurfaceAndNoPicture) {
  const auto volume =
      testing::sample_field(testing::small_plan(), [](const glm::dvec3&) { return 0.0; });
  const Picture picture = render_volume(gl_context(), volume, testing::small_options());
  EXPECT_EQ(hits(picture.depth_m), 0);
  for (const glm::vec3& pixel : picture.surface.pixels) EXPECT_EQ(pixel, glm::vec3(0));
  for (const glm::vec3& pixel : picture.volume.pixels) EXPECT_EQ(pixel, glm::vec3(0));
}

TEST(Renderer, UniformDataHasNoSurfaceAtTheBordersOfTheCone) {
  const auto volume =
      testing::sample_field(testing::small_plan(), [](const glm::dvec3&) { return 1.0; });
  RenderOptions options = testing::small_options();
  options.volume_of_interest.center_m = {0, 0, 0.1};
  options.volume_of_interest.size_m = {0.25, 0.25, 0.22};
  for (EdgeSign edge : {EdgeSign::rising, EdgeSign::falling}) {
    options.ray_casting.edge = edge;
    EXPECT_EQ(hits(render_volume(gl_context(), volume, options).depth_m), 0);
  }
}

TEST(Renderer, BadSamplesAffectOnlyTheirNeighbourhood) {
  const hw::PolarVolume& clean = testing::noisy_scene();
  const hw::AcquisitionPlan& plan = clean.plan();
  RenderOptions options = testing::small_options();
  options.shading.depth_filter_size = 1;
  options.smoothing.filter_size = 1;
  const Picture expected = render_volume(gl_context(), clean, options);
  const int frame = 10, line = 24, sample = 60;
  const glm::dvec3 position = plan.geometry().to_cartesian(
      {plan.sample_range_m(sample), plan.theta_rad(line), plan.frame_phi_rad(frame)});
  const PicturePoint point = make_camera(options).project(position);
  const float bad_samples[] = {std::numeric_limits<float>::quiet_NaN(),
                               std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::denorm_min(),
                               1e30f,
                               -1e30f};
  for (float bad : bad_samples) {
    Renderer renderer(gl_context(), plan, options);
    for (int f = 0; f < 21; ++f) {
      hw::PolarFrame copy = clean.frame(f);
      if (f == frame) copy.samples[line * 160 + sample] = bad;
      renderer.add_frame(f, copy);
    }
    const Picture picture = renderer.render();
    for (int row = 0; row < options.ray_casting.image_size; ++row) {
      for (int column = 0; column < options.ray_casting.image_size; ++column) {
        const float z = picture.depth_m.at(column, row), v = picture.volume.at(column, row).r;
        EXPECT_TRUE(std::isfinite(v));
        // Neighbouring sticks and frames are about 5 mm, less than 4 pixels, away; kernels add 2.
        if (std::hypot(column - point.column, row - point.row) < 8) continue;
        EXPECT_EQ(std::isnan(z), std::isnan(expected.depth_m.at(column, row)));
        if (!std::isnan(z)) {
          EXPECT_EQ(z, expected.depth_m.at(column, row));
        }
        EXPECT_EQ(v, expected.volume.at(column, row).r);
      }
    }
  }
}

TEST(Renderer, TheLitSideOfASphereIsTheOneTowardsTheLight) {
  const auto volume =
      testing::sample_field(testing::small_plan(), testing::sphere({0, 0, 0.12}, 0.03, 4e-3));
  RenderOptions options = testing::small_options();
  options.shading.light_left_rad = 50 * kDegree;
  options.shading.light_up_rad = 40 * kDegree;
  const Picture picture = render_volume(gl_context(), volume, options);
  const float upper_left = picture.surface.at(15, 15).g, lower_right = picture.surface.at(24, 24).g;
  const float upper_right = picture.surface.at(24, 15).g, lower_left = picture.surface.at(15, 24).g;
  EXPECT_GT(upper_left, upper_right);
  EXPECT_GT(upper_left, lower_left);
  EXPECT_GT(upper_right, lower_right);
  EXPECT_GT(lower_left, lower_right);
}

TEST(Renderer, RefusesTexturesBeyondTheDriversLimits) {
  hw::AcquisitionOptions acquisition;
  acquisition.frames_per_volume = 1024;
  RenderOptions options;
  options.scan_conversion.slice_size = 2048;
  options.ray_casting.stop_at_box = false;  // else mode fast stores only the pixels in the box
  for (const auto& [mode, need] :
       {std::pair(PipelineMode::plain, "8192 MiB"), std::pair(PipelineMode::fast, "16368 MiB")}) {
    options.pipeline.mode = mode;
    const std::string refusal = refusal_of<std::runtime_error>([&] {
      Renderer renderer(gl_context(), {hw::ProbeOptions{}, acquisition}, options);
    });
    const std::string expected =
        std::string("scan_conversion.slice_size = 2048, 1024 frames: needs ") + need;
    EXPECT_TRUE(refusal.starts_with(expected)) << refusal;
  }
}

TEST(Renderer, RefusesBadOptions) {
  RenderOptions options;
  options.ray_casting.kernel_3d = 2;
  EXPECT_THROW(Renderer(gl_context(), testing::small_plan(), options), InvalidOption);
}

struct Extreme {
  const char* name;
  void (*change)(hw::ProbeOptions&, hw::AcquisitionOptions&, RenderOptions&);
};
class Extremes : public ::testing::TestWithParam<Extreme> {};

TEST_P(Extremes, GiveFinitePictures) {
  hw::ProbeOptions probe;
  hw::AcquisitionOptions acquisition = testing::small_plan().acquisition();
  RenderOptions options = testing::small_options();
  options.ray_casting.image_size = 24;
  GetParam().change(probe, acquisition, options);
  const auto volume = testing::sample_field(
      {probe, acquisition}, testing::noisy(testing::sphere({0, 0, 0.12}, 0.03, 0), 0.1, 2));
  const Picture picture = render_volume(gl_context(), volume, options);
  for (const glm::vec3& pixel : picture.surface.pixels)
    EXPECT_TRUE(std::isfinite(pixel.r + pixel.g));
  for (const glm::vec3& pixel : picture.volume.pixels) EXPECT_TRUE(std::isfinite(pixel.r));
  for (float z : picture.depth_m.pixels) EXPECT_TRUE(std::isnan(z) || (z >= 0 && z < 10));
}

const Extreme kExtremes[] = {
    {"one_frame", [](auto&, auto& a, auto&) { a.frames_per_volume = 1; }},
    {"one_stick", [](auto&, auto& a, auto&) { a.sticks_per_frame = 1; }},
    {"two_samples", [](auto&, auto& a, auto&) { a.samples_per_stick = 2; }},
    {"narrow", [](auto&, auto& a, auto&) { a.sector_rad = a.fan_rad = 0.1 * kDegree; }},
    {"wide", [](auto&, auto& a, auto&) { a.sector_rad = a.fan_rad = 170 * kDegree; }},
    {"axis_on_the_face", [](auto& p, auto&, auto&) { p.wobble_radius_m = 0; }},
    {"axis_at_the_centre", [](auto& p, auto&, auto&) { p.wobble_radius_m = p.radius_m; }},
    {"axis_behind_the_centre", [](auto& p, auto&, auto&) { p.wobble_radius_m = 2 * p.radius_m; }},
    {"shallow", [](auto&, auto& a, auto&) { a.depth_m = 1e-3; }},
    {"one_pixel", [](auto&, auto&, auto& o) { o.ray_casting.image_size = 1; }},
    {"kernel_wider_than_the_picture", [](auto&, auto&, auto& o) { o.ray_casting.image_size = 3; }},
    {"one_step", [](auto&, auto&, auto& o) { o.ray_casting.steps = 1; }},
    {"light_on_the_surface",
     [](auto&, auto&, auto& o) {
       o.shading.light_up_rad = 0;
       o.shading.light_distance_m = 0.03;
     }},
};

INSTANTIATE_TEST_SUITE_P(Scans,
                         Extremes,
                         ::testing::ValuesIn(kExtremes),
                         [](const auto& param_info) { return param_info.param.name; });

}  // namespace
}  // namespace wobblebench::render
