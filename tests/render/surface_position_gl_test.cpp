// z of known surfaces against closed forms, with the bias stated at RayCaster.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "render/camera.h"
#include "render/geometry/slice_geometry.h"
#include "render/renderer.h"
#include "tests/render/support/gl_fixture.h"
#include "tests/render/support/synthetic.h"

namespace wobblebench::render {
namespace {

constexpr double kContrast = testing::kInside - testing::kOutside;

/// Sticks and frames about 0.5 mm apart, so that the edge is sharp compared with half the buffer
/// (8 steps of 0.31 mm).
hw::AcquisitionPlan dense_plan() {
  hw::AcquisitionOptions acquisition;
  acquisition.depth_m = 0.08;
  acquisition.sector_rad = 16 * kDegree;
  acquisition.fan_rad = 14 * kDegree;
  acquisition.sticks_per_frame = 64;
  acquisition.samples_per_stick = 512;
  acquisition.frames_per_volume = 48;
  return {hw::ProbeOptions{}, acquisition};
}

RenderOptions dense_options(double threshold) {
  RenderOptions options;
  options.scan_conversion.slice_size = 512;
  options.scan_conversion.filter_size = 1;
  options.volume_of_interest.center_m = {0, 0, 0.09};
  options.volume_of_interest.size_m = {0.016, 0.016, 0.020};
  options.ray_casting.mode = RenderMode::surface;
  options.ray_casting.image_size = 32;
  options.ray_casting.steps = 64;
  options.ray_casting.buffer_length = 16;
  options.ray_casting.threshold = threshold;
  options.shading.shadows = false;
  return options;
}

/// Depth error in steps over the pixels where `truth` gives a depth; negative: too near.
struct Errors {
  double mean = 0, spread = 0;
  int count = 0;
};

Errors errors(const Picture& picture,
              const RenderOptions& options,
              const std::function<double(const hw::Ray&)>& truth) {
  const Camera camera = make_camera(options);
  double sum = 0, squares = 0;
  Errors result;
  for (int row = 0; row < picture.depth_m.height; ++row) {
    for (int column = 0; column < picture.depth_m.width; ++column) {
      const double expected_m = truth(camera.ray(column, row));
      if (std::isnan(expected_m)) continue;
      const double z_m = picture.depth_m.at(column, row);
      EXPECT_FALSE(std::isnan(z_m)) << "missed at " << column << ", " << row;
      if (std::isnan(z_m)) continue;
      const double error = (z_m - expected_m) / step_m(options);
      sum += error;
      squares += error * error;
      ++result.count;
    }
  }
  result.mean = sum / result.count;
  result.spread = std::sqrt(squares / result.count - result.mean * result.mean);
  return result;
}

struct Surface {
  const char* name;
  testing::Field field;
  /// Ray length at the surface; NaN: not tested.
  std::function<double(const hw::Ray&)> truth;
};

Surface plane(const char* name, const glm::dvec3& normal) {
  const glm::dvec3 point(0, 0, 0.09);
  return {name, testing::plane(point, normal, 0), [=](const hw::Ray& ray) {
            return glm::dot(point - ray.origin, normal) / glm::dot(ray.direction, normal);
          }};
}

/// Tested where its normal is within 45 degrees of the viewer's direction.
Surface sphere() {
  const glm::dvec3 center(0.001, -0.001, 0.095);
  const double radius_m = 0.009;
  return {"sphere", testing::sphere(center, radius_m, 0), [=](const hw::Ray& ray) {
            const glm::dvec3 offset = center - ray.origin;
            const double along = glm::dot(offset, ray.direction);
            const double aside2 = glm::dot(offset, offset) - along * along;
            if (aside2 > 0.5 * radius_m * radius_m) return std::nan("");
            return along - std::sqrt(radius_m * radius_m - aside2);
          }};
}

class SurfacePosition : public ::testing::TestWithParam<Surface> {};

TEST_P(SurfacePosition, IsBehindTheEdgeByThresholdOverContrastMinusHalfAStep) {
  const auto volume = testing::sample_field(dense_plan(), GetParam().field);
  for (double contrasts : {3.0, 4.0, 5.0}) {
    const RenderOptions options = dense_options(contrasts * kContrast);
    const Picture picture = render_volume(testing::gl_context(), volume, options);
    const Errors e = errors(picture, options, GetParam().truth);
    ASSERT_GT(e.count, 300);
    EXPECT_NEAR(e.mean, contrasts - 0.5, 0.1);
    EXPECT_LT(e.spread, 0.5);
  }
}

TEST_P(SurfacePosition, WithoutInterpolationIsHalfAStepDeeper) {
  const auto volume = testing::sample_field(dense_plan(), GetParam().field);
  RenderOptions options = dense_options(4 * kContrast);
  options.ray_casting.refine_crossing = false;
  const Picture picture = render_volume(testing::gl_context(), volume, options);
  const Errors e = errors(picture, options, GetParam().truth);
  EXPECT_NEAR(e.mean, 4, 0.25);  // the half step is a mean over edge positions
}

TEST_P(SurfacePosition, DoesNotDependOnTheKernel) {
  const auto volume = testing::sample_field(dense_plan(), GetParam().field);
  for (int kernel : {1, 5}) {
    RenderOptions options = dense_options(4 * kContrast);
    options.ray_casting.kernel_3d = kernel;
    const Picture picture = render_volume(testing::gl_context(), volume, options);
    EXPECT_NEAR(errors(picture, options, GetParam().truth).mean, 3.5, 0.15) << "kernel " << kernel;
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces,
                         SurfacePosition,
                         ::testing::Values(plane("plane", {0, 0, -1}),
                                           plane("tilted_plane", {0.25, -0.2, -1}),
                                           sphere()),
                         [](const auto& param_info) { return param_info.param.name; });

TEST(SurfacePositionFalling, FindsTheFarSideOfASlabAsAFallingEdge) {
  const auto slab = [](const glm::dvec3& p) {
    return p.z > 0.084 && p.z < 0.092 ? testing::kInside : testing::kOutside;
  };
  const auto volume = testing::sample_field(dense_plan(), slab);
  RenderOptions options = dense_options(4 * kContrast);
  options.ray_casting.edge = EdgeSign::falling;
  const Picture picture = render_volume(testing::gl_context(), volume, options);
  const Errors e = errors(picture, options, [](const hw::Ray& ray) {
    return (0.092 - ray.origin.z) / ray.direction.z;
  });
  EXPECT_NEAR(e.mean, 3.5, 0.1);
}

/// Tissue from the probe's face down to the middle of the dense box, fluid behind it.
hw::PolarVolume tissue_above() {
  return testing::sample_field(dense_plan(), [](const glm::dvec3& at_m) {
    return at_m.z < 0.09 ? testing::kInside : testing::kOutside;
  });
}

RenderOptions capped(PipelineMode mode) {
  RenderOptions options = dense_options(0);
  options.pipeline.mode = mode;
  options.ray_casting.detector = Detector::iso;
  options.ray_casting.iso_level = 0.5;
  options.ray_casting.caps = true;
  return options;
}

TEST(Caps, StandWhereRaysEnterTheScanInTissue) {
  const hw::PolarVolume volume = tissue_above();
  const SliceGeometry scan(dense_plan(), 512);
  for (const PipelineMode mode : {PipelineMode::plain, PipelineMode::fast}) {
    RenderOptions options = capped(mode);
    options.volume_of_interest = {{0, 0, 0.06}, {0.02, 0.02, 0.06}};  // begins behind the face
    const Picture picture = render_volume(testing::gl_context(), volume, options);
    const Camera camera = make_camera(options);
    int count = 0;
    for (int row = 0; row < picture.depth_m.height; ++row) {
      for (int column = 0; column < picture.depth_m.width; ++column) {
        const auto z_m = static_cast<double>(picture.depth_m.at(column, row));
        if (std::isnan(z_m)) continue;
        ++count;
        const hw::Ray ray = camera.ray(column, row);
        EXPECT_TRUE(scan.locate(ray.at(z_m + 1e-6)).inside);
        EXPECT_FALSE(scan.locate(ray.at(z_m - 1.01 * step_m(options))).inside);
      }
    }
    EXPECT_GT(count, 500);
    options.ray_casting.caps = false;
    EXPECT_EQ(testing::hits(render_volume(testing::gl_context(), volume, options).depth_m), 0);
  }
}

/// As in the truth, which has no caps.
TEST(Caps, StandNowhereWhereRaysBeginInTheScan) {
  const hw::PolarVolume volume = tissue_above();
  for (const PipelineMode mode : {PipelineMode::plain, PipelineMode::fast}) {
    const Picture picture = render_volume(testing::gl_context(), volume, capped(mode));
    EXPECT_EQ(testing::hits(picture.depth_m), 0);
  }
}

TEST(Caps, ChangeNoRayThatBeginsInFluid) {
  RenderOptions options = dense_options(0);
  options.ray_casting.detector = Detector::iso;
  const hw::PolarVolume volume =
      testing::sample_field(dense_plan(), testing::sphere({0, 0, 0.092}, 0.005, 1e-3));
  const Picture without = render_volume(testing::gl_context(), volume, options);
  options.ray_casting.caps = true;
  const Picture with = render_volume(testing::gl_context(), volume, options);
  EXPECT_GT(testing::hits(without.depth_m), 100);
  EXPECT_TRUE(testing::same_bits(with.depth_m, without.depth_m));
}

}  // namespace
}  // namespace wobblebench::render
