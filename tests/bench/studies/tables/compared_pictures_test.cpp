// Pictures of two contexts against each other, on made-up ones; their file.
#include "bench/studies/tables/compared_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/studies/tables/tables_report.h"

namespace wobblebench::bench {
namespace {

constexpr int kSide = 10;  // 100 pixels

/// A plane at 100 mm that a filter's rounding may move by 0.02 mm.
ComparedPicture plane(const std::string& settings) {
  return {.settings = settings,
          .nearest_m = {kSide, kSide, 0.09998F},
          .cast_m = {kSide, kSide, 0.1F},
          .farthest_m = {kSide, kSide, 0.10002F},
          .surface = {kSide, kSide, glm::vec3(0.5F)}};
}

std::vector<ComparedPicture> planes() {
  return {plane("paper"), plane("default")};
}

PictureAgreement agreement_after(const std::function<void(ComparedPicture&)>& change) {
  auto here = planes();
  change(here[0]);
  const auto agreements = compare_pictures(here, planes());
  EXPECT_EQ(agreements.at(1).z_largest_mm, 0);
  return agreements.at(0);
}

TEST(ComparedPictures, AShiftWithinTheBoundsIsExplained) {
  const auto agreement = agreement_after([](ComparedPicture& picture) {
    for (float& z : picture.cast_m.pixels) z += 15e-6F;
  });
  EXPECT_NEAR(agreement.z_rms_mm, 0.015, 1e-4);
  EXPECT_NEAR(agreement.z_largest_mm, 0.015, 1e-4);
  EXPECT_EQ(agreement.unexplained_share, 0);
  EXPECT_EQ(agreement.pixels, 100);
}

TEST(ComparedPictures, AShiftBeyondThemIsNot) {
  const auto agreement = agreement_after([](ComparedPicture& picture) {
    picture.cast_m.at(3, 3) += 50e-6F;
    picture.cast_m.at(4, 4) -= 50e-6F;
  });
  EXPECT_NEAR(agreement.unexplained_share, 0.02, 1e-12);
  EXPECT_NEAR(agreement.z_rms_mm, 0.05 * std::sqrt(0.02), 1e-4);
}

TEST(ComparedPictures, ASurfaceInOneAloneIsExplainedOnlyWhereABoundHasNone) {
  const auto lose = [](ComparedPicture& picture) { picture.cast_m.at(0, 0) = kNoSurface; };
  EXPECT_NEAR(agreement_after(lose).unexplained_share, 0.01, 1e-12);
  EXPECT_NEAR(agreement_after(lose).found_in_one_share, 0.01, 1e-12);
  auto here = planes(), other = planes();
  lose(here[0]);
  other[0].farthest_m.at(0, 0) = kNoSurface;
  EXPECT_EQ(compare_pictures(here, other).at(0).unexplained_share, 0);
}

TEST(ComparedPictures, LightIsComparedChannelByChannel) {
  const auto agreement =
      agreement_after([](ComparedPicture& picture) { picture.surface.at(9, 9).g += 0.25F; });
  EXPECT_NEAR(agreement.light_largest, 0.25, 1e-6);
  EXPECT_NEAR(agreement.light_rms, 0.25 / std::sqrt(300.0), 1e-6);
}

TEST(ComparedPictures, OneInAThousandMayBeUnexplained) {
  const auto all_explained = [](double share) {
    PictureAgreement agreement;
    agreement.unexplained_share = share;
    return PicturesAgainst{"another", {{}, agreement}}.all_explained();
  };
  EXPECT_TRUE(all_explained(0.001));
  EXPECT_FALSE(all_explained(0.0011));
}

TEST(ComparedPictures, SurviveTheirFile) {
  auto pictures = planes();
  pictures[1].cast_m.at(2, 5) = kNoSurface;
  pictures[0].surface.at(7, 1) = {0.1F, 0.2F, 0.3F};
  const auto read = read_compared(compared_bytes(pictures));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[1].settings, "default");
  EXPECT_TRUE(std::isnan(read[1].cast_m.at(2, 5)));
  EXPECT_EQ(read[0].farthest_m.pixels, pictures[0].farthest_m.pixels);
  EXPECT_EQ(read[0].surface.at(7, 1), pictures[0].surface.at(7, 1));
}

TEST(ComparedPictures, FilesOfAnotherKindAreRefused) {
  const std::string bytes = compared_bytes(planes());
  EXPECT_THROW(read_compared(bytes.substr(0, 500)), std::invalid_argument);
  EXPECT_THROW(read_compared(compared_bytes({plane("paper")})), std::invalid_argument);
  EXPECT_THROW(read_compared("no array"), std::invalid_argument);
}

TEST(ComparedPictures, OfOtherSizesAreRefused) {
  auto other = planes();
  other[1].cast_m = {kSide, kSide + 1};
  EXPECT_THROW(compare_pictures(planes(), other), std::invalid_argument);
}

}  // namespace
}  // namespace wobblebench::bench
