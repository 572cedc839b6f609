#include "bench/studies/modes/mode_agreement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace wobblebench::bench {
namespace {

constexpr double kStep_m = 1e-4;
constexpr float kNone = kNoSurface;

Image<float> picture(const std::vector<float>& depths_m) {
  Image<float> image(static_cast<int>(depths_m.size()), 1);
  image.pixels = depths_m;
  return image;
}

TEST(ModeAgreement, CountsSurfacesOfOnePictureAlone) {
  const auto found = compare_depths(
      picture({kNone, 0.1f, kNone, 0.1f}), picture({kNone, 0.1f, 0.1f, kNone}), kStep_m);
  EXPECT_EQ(found.pixels, 4);
  EXPECT_EQ(found.both_hit, 1);
  EXPECT_EQ(found.one_hit, 2);
  EXPECT_EQ(found.elsewhere, 0);
  EXPECT_DOUBLE_EQ(found.changed_percent(), 50);
  EXPECT_FALSE(found.same());
}

TEST(ModeAgreement, SeparatesPixelsOfDifferentSurfaces) {
  // 0.3 and 0.4 steps apart, and 100.
  const auto found =
      compare_depths(picture({0.1f, 0.1f, 0.1f}), picture({0.10003f, 0.09996f, 0.11f}), kStep_m);
  EXPECT_EQ(found.elsewhere, 1);
  EXPECT_NEAR(found.rms_steps, std::sqrt((0.09 + 0.16) / 2), 1e-3);
  EXPECT_NEAR(found.rms_all_steps, std::sqrt((0.09 + 0.16 + 1e4) / 3), 1e-2);
  EXPECT_NEAR(found.worst_steps, 100, 1e-2);
}

TEST(ModeAgreement, OfEmptyPicturesIsComplete) {
  const auto found = compare_depths(picture({kNone, kNone}), picture({kNone, kNone}), kStep_m);
  EXPECT_EQ(found.both_hit, 0);
  EXPECT_EQ(found.rms_steps, 0);
  EXPECT_TRUE(found.same());
}

TEST(ModeAgreement, RefusesPicturesOfTwoSizes) {
  EXPECT_THROW(compare_depths(picture({0.1f}), picture({0.1f, 0.1f}), kStep_m),
               std::invalid_argument);
}

TEST(ModeAgreement, HasFiveDifferentDirections) {
  const auto& directions = five_directions();
  ASSERT_EQ(directions.size(), 5u);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_TRUE(directions[i].yaw_rad != directions[j].yaw_rad ||
                  directions[i].pitch_rad != directions[j].pitch_rad);
    }
  }
}

}  // namespace
}  // namespace wobblebench::bench
