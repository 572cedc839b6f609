// What report.html of `run` makes of a result.
#include "bench/cli/run/run_page.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/cli/board_report.h"
#include "bench/cli/run/run_pictures.h"

namespace wobblebench::bench {
namespace {

TEST(RunPage, ListsTheSummary) {
  EXPECT_EQ(summary_list("board       12 sticks emitted\n"
                         "depth error bias 0.1 mm\n"
                         "registered  5 points\n"
                         "            shift_x 1 mm\n"
                         "results     /home/out\n"),
            "- **board** 12 sticks emitted\n- **depth error** bias 0.1 mm\n"
            "- **registered** 5 points; shift_x 1 mm\n");
}

/// Of five pixels one has no error, and one lies beyond the histogram.
TEST(RunPage, CountsErrorsInBinsAndBelowLengths) {
  Image<float> error_m(5, 1);
  error_m.pixels = {kNoSurface, 0.04e-3f, 0.06e-3f, -0.25e-3f, 7e-3f};
  const Figure figure = error_figure(error_m);
  const auto at = [](const Series& series, double x) {
    double value = std::nan("");
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (std::abs(series.x[i] - x) < 1e-9) value = series.y[i];
    }
    return value;
  };
  const Series bars = std::get<Chart>(figure.panels.at(0)).series.at(0);
  // Two points a bin; of those at a bin's end the later begins the next bin.
  EXPECT_DOUBLE_EQ(at(bars, 0.0), 50);
  EXPECT_DOUBLE_EQ(at(bars, -0.3), 25);
  EXPECT_DOUBLE_EQ(at(bars, 0.1), 0);
  const Series share = std::get<Chart>(figure.panels.at(1)).series.at(0);
  EXPECT_DOUBLE_EQ(at(share, 0.0), 0);
  EXPECT_DOUBLE_EQ(at(share, 0.05), 25);
  EXPECT_DOUBLE_EQ(at(share, 0.1), 50);
  EXPECT_DOUBLE_EQ(at(share, 0.3), 75);
  EXPECT_DOUBLE_EQ(at(share, 5.0), 75);
}

TEST(RunPictures, VolumeIsBlackWhereNothingIsAndRisesWithTheGreyLevel) {
  Picture3 volume(100, 1);
  for (int i = 0; i < 100; ++i) volume.at(i, 0) = glm::vec3(0.006f * static_cast<float>(i));
  const Picture3 shown = shown_volume(volume);
  EXPECT_EQ(shown.at(0, 0), glm::vec3(0));
  for (int i = 1; i < 100; ++i) EXPECT_GE(shown.at(i, 0).g, shown.at(i - 1, 0).g) << i;
  EXPECT_NEAR(shown.at(99, 0).r, 1, 1e-6) << "the brightest is white";
  const Picture3 none = shown_volume(Picture3(8, 8));
  for (const glm::vec3& pixel : none.pixels) EXPECT_EQ(pixel, glm::vec3(0));
}

}  // namespace
}  // namespace wobblebench::bench
