// Pictures of errors and echoes: their colours, and where lines and values lie.
#include <gtest/gtest.h>

#include <cmath>

#include "bench/output/picture/error_picture.h"
#include "bench/output/picture/scan_plane.h"

namespace wobblebench::bench {
namespace {

/// 0xRRGGBB.
std::uint32_t rgb(const glm::vec3& colour) {
  std::uint32_t value = 0;
  for (int i = 0; i < 3; ++i) {
    value = 256 * value + static_cast<std::uint32_t>(std::lround(255 * colour[i]));
  }
  return value;
}

TEST(ErrorPicture, IsBlueInFrontWhiteWhereTrueAndRedBehind) {
  Image<float> error_m(7, 1);
  error_m.pixels = {-9e-3f, -3e-3f, -1.5e-3f, 0, 1.5e-3f, 3e-3f, kNoSurface};
  const Panel panel = error_panel(error_m);
  const std::uint32_t expected[] = {
      0x1a4b9c, 0x1a4b9c, 0x6fa8dc, 0xf7f7f7, 0xf0906a, 0xb2182b, 0x2b2b2b};
  for (int column = 0; column < 7; ++column) {
    EXPECT_EQ(rgb(panel.picture.at(column, 0)), expected[column]) << column;
  }
  EXPECT_EQ(panel.bar->low, -3);
  EXPECT_EQ(panel.bar->high, 3);
  EXPECT_TRUE(panel.names.empty());
}

/// Found, not found or drawn beyond what was found, against each kind of truth.
TEST(ErrorPicture, ClassesHaveColoursOfTheirOwn) {
  const TruthKind kinds[] = {TruthKind::none,
                             TruthKind::surface,
                             TruthKind::outside_field,
                             TruthKind::grazing,
                             TruthKind::shadowed};
  Image<float> error_m(5, 3, kNoSurface);
  render::Picture found{.depth_m = {5, 3, kNoSurface}, .drawn = {5, 3}};
  Truth truth{{5, 3, 0.1f}, {5, 3}, {5, 3}};
  for (int column = 0; column < 5; ++column) {
    found.depth_m.at(column, 1) = found.depth_m.at(column, 2) = 0.1f;
    found.drawn.at(column, 2) = 1;
    for (int row = 0; row < 3; ++row) truth.kind.at(column, row) = kinds[column];
  }
  error_m.at(1, 1) = error_m.at(1, 2) = 0;
  const auto classes = pixel_classes(found, truth);
  const Panel panel = error_panel(error_m, classes);
  const std::uint32_t expected[3][5] = {{0x2b2b2b, 0xf0d000, 0x6b5a2e, 0x8f8f8f, 0xa45bb5},
                                        {0x00b37d, 0xf7f7f7, 0x6b5a2e, 0x8f8f8f, 0xa45bb5},
                                        {0xe07ab8, 0xe07ab8, 0xe07ab8, 0xe07ab8, 0xe07ab8}};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 5; ++column) {
      EXPECT_EQ(rgb(panel.picture.at(column, row)), expected[row][column]) << column << " " << row;
    }
  }
  EXPECT_EQ(panel.names.size(), 6u);
}

TEST(Panels, TicksAreAtRoundNumbers) {
  EXPECT_DOUBLE_EQ(tick_step(-3, 3, 13), 0.5);
  EXPECT_DOUBLE_EQ(tick_step(-3, 3, 7), 1);
  EXPECT_DOUBLE_EQ(tick_step(0, 83, 5), 50);
  EXPECT_DOUBLE_EQ(tick_step(0, 0.004, 5), 0.001);
}

TEST(Panels, KeepPixelsThatAreStretchedByAWholeNumber) {
  Picture3 picture(2, 1);
  picture.at(0, 0) = {1, 0, 0};
  picture.at(1, 0) = {0, 0, 1};
  const Picture3 drawn = draw_panels({{.title = "two", .picture = picture}}, 100);
  int red = 0, blue = 0;
  for (const glm::vec3& pixel : drawn.pixels) {
    red += rgb(pixel) == 0xff0000 ? 1 : 0;
    blue += rgb(pixel) == 0x0000ff ? 1 : 0;
  }
  EXPECT_EQ(red, 50 * 50);
  EXPECT_EQ(blue, 50 * 50);
  EXPECT_THROW(draw_panels({}, 100), std::invalid_argument);
}

TEST(Panels, WordsStandInThePlaceOfAPicture) {
  const Panel panel{.title = "error", .picture = {4, 4}, .instead = "No error: nothing is known."};
  const Picture3 drawn = draw_panels({panel}, 200);
  int black = 0;
  for (const glm::vec3& pixel : drawn.pixels) black += rgb(pixel) == 0 ? 1 : 0;
  EXPECT_EQ(black, 0) << "the picture is not drawn";
  EXPECT_GT(drawn.height, 200);
}

render::Camera camera_of(int size) {
  render::RenderOptions options;
  options.ray_casting.image_size = size;
  return render::make_camera(options);
}

/// The near side of a ball, as parallel rays meet it.
Image<float> depth_of_ball(const render::Camera& camera, const glm::dvec3& center, double radius) {
  Image<float> depth_m(camera.image_size, camera.image_size, kNoSurface);
  for (int row = 0; row < camera.image_size; ++row) {
    for (int column = 0; column < camera.image_size; ++column) {
      const hw::Ray ray = camera.ray(column, row);
      const glm::dvec3 from = ray.origin - center;
      const double square = radius * radius - from.x * from.x - from.y * from.y;
      if (square < 0) continue;
      depth_m.at(column, row) = static_cast<float>(-from.z - std::sqrt(square));
    }
  }
  return depth_m;
}

/// A plane at a distance h of a ball's centre cuts it in a circle of radius sqrt(R^2 - h^2).
TEST(ScanPlane, CutsABallInACircle) {
  const render::Camera camera = camera_of(128);
  const hw::AcquisitionPlan plan({}, {});
  const glm::dvec3 center(4e-3, 6e-3, 0.12);
  const double radius_m = 25e-3;
  const auto depth_m = depth_of_ball(camera, center, radius_m);
  const ScanPlane across = plane_across_frames(plan, 300);
  const ScanPlane frame = frame_plane(plan, 18, 300);  // of 37: the motor angle is 0
  const struct {
    const ScanPlane& plane;
    double height_m;
  } cases[] = {{across, 4e-3}, {frame, 6e-3}};
  for (const auto& [plane, height_m] : cases) {
    const auto segments = surface_in_plane(depth_m, camera, plane);
    EXPECT_GT(segments.size(), 40u);
    const double expected_m = std::sqrt(radius_m * radius_m - height_m * height_m);
    for (const Segment& segment : segments) {
      for (const glm::dvec2& end : segment) {
        const glm::dvec3 at = plane.position_m(end.x, end.y) - center;
        // In the plane, and on the circle but for the chord between two pixels 0.8 mm apart.
        const double off_axis = std::hypot(at.x, at.y, at.z);
        EXPECT_NEAR(off_axis, radius_m, 0.4e-3);
        const double square = off_axis * off_axis - height_m * height_m;
        EXPECT_NEAR(std::sqrt(square), expected_m, 0.4e-3);
      }
    }
  }
}

/// Samples that rise by 1 over the depth, by 2 over the sector and by 4 over the fan.
hw::PolarVolume ramps(const hw::AcquisitionPlan& plan) {
  const hw::AcquisitionOptions& scan = plan.acquisition();
  std::vector<float> samples;
  for (int frame = 0; frame < scan.frames_per_volume; ++frame) {
    for (int line = 0; line < scan.sticks_per_frame; ++line) {
      for (int k = 0; k < scan.samples_per_stick; ++k) {
        samples.push_back(static_cast<float>((k + 0.5) / scan.samples_per_stick +
                                             2.0 * line / (scan.sticks_per_frame - 1) +
                                             4.0 * frame / (scan.frames_per_volume - 1)));
      }
    }
  }
  return hw::PolarVolume::of_samples(plan, 0, hw::SampleScale::log_compressed, samples);
}

/// In the frame at rest a pixel at (x, z) is at the range hypot(x, z) - a and the angle atan(x /
/// z).
TEST(ScanPlane, ShowsSamplesWhereTheirSticksLie) {
  const hw::AcquisitionPlan plan({}, {.sticks_per_frame = 16, .frames_per_volume = 9});
  const hw::PolarVolume volume = ramps(plan);
  const ScanPlane plane = frame_plane(plan, 4, 120);
  const auto picture = scan_converted(volume, plane);
  const double a = plan.probe().radius_m, depth_m = plan.acquisition().depth_m;
  const double sector_rad = plan.acquisition().sector_rad;
  int inside = 0;
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 120; ++column) {
      const glm::dvec3 at = plane.position_m(column, row);
      const double range = (std::hypot(at.x, at.z) - a) / depth_m;
      const double angle = std::atan2(at.x, at.z) / sector_rad;
      const auto value = static_cast<double>(picture.at(column, row));
      EXPECT_EQ(std::isnan(value), range < 0 || range > 1 || std::abs(angle) > 0.5);
      if (std::isnan(value)) continue;
      ++inside;
      EXPECT_NEAR(value, range + 2 * (angle + 0.5) + 2, 2e-3) << column << " " << row;
    }
  }
  EXPECT_GT(inside, 4000);
}

/// In the plane x = 0 a pixel is at the motor angle atan(-y / (z - b)), b = a - w.
TEST(ScanPlane, AcrossFramesShowsSamplesAtTheirMotorAngles) {
  const hw::AcquisitionPlan plan({}, {.sticks_per_frame = 17, .frames_per_volume = 9});
  const ScanPlane plane = plane_across_frames(plan, 120);
  const auto picture = scan_converted(ramps(plan), plane);
  const double b = plan.probe().radius_m - plan.probe().wobble_radius_m;
  const double a = plan.probe().radius_m, depth_m = plan.acquisition().depth_m;
  int inside = 0;
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 120; ++column) {
      const auto value = static_cast<double>(picture.at(column, row));
      if (std::isnan(value)) continue;
      const glm::dvec3 at = plane.position_m(column, row);
      const double range = (std::hypot(at.y, at.z - b) + b - a) / depth_m;
      const double phi = std::atan2(-at.y, at.z - b) / plan.acquisition().fan_rad;
      EXPECT_NEAR(value, range + 1 + 4 * (phi + 0.5), 2e-3) << column << " " << row;
      ++inside;
    }
  }
  EXPECT_GT(inside, 4000);
}

}  // namespace
}  // namespace wobblebench::bench
