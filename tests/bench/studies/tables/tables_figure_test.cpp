#include "bench/studies/tables/tables_command.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <glm/common.hpp>

#include "bench/output/image_io.h"
#include "tests/bench/studies/tables/made_up.h"

namespace wobblebench::bench {
namespace {

/// Pixels of nearly this colour.
long count(const Picture3& picture, Colour colour) {
  return std::count_if(picture.pixels.begin(), picture.pixels.end(), [&](const Colour& pixel) {
    const Colour difference = glm::abs(pixel - colour);
    return std::max({difference.r, difference.g, difference.b}) < 0.02f;
  });
}

TEST(TablesFigure, ShowsPaperPlainAndFastInFourPanels) {
  const Picture3 picture = draw_tables(testing::made_up_results());
  EXPECT_GT(picture.width, picture.height);
  // For inspection by eye.
  if (const char* path = std::getenv("WOBBLEBENCH_TABLES_PNG")) write_png(path, picture);
  for (const int series : {0, 2, 6}) EXPECT_GT(count(picture, series_colour(series)), 500);
  auto without = testing::made_up_results();
  without.tables.pop_back();
  EXPECT_ANY_THROW(draw_tables(without));
}

}  // namespace
}  // namespace wobblebench::bench
