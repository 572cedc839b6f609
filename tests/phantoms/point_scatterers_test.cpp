#include "phantoms/point_scatterers.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "phantoms/phantom.h"

namespace wobblebench::phantoms {
namespace {

PointScatterers moving() {
  PointScatterers points;
  points.add({{1, 2, 3}, -0.5});
  points.add_track({{1, {{0, 0, 0}, 1}}, {2, {{4, 0, 0}, 0}}, {4, {{4, 8, 0}, -1}}});
  return points;
}

TEST(PointScatterers, AreLinearBetweenKeysAndStayBeyondThem) {
  const PointScatterers points = moving();
  for (const double time_s : {-5.0, 0.0, 9.0}) {
    EXPECT_EQ(points.at(0, time_s), (PointScatterer{{1, 2, 3}, -0.5}));
  }
  EXPECT_EQ(points.at(1, 0), (PointScatterer{{0, 0, 0}, 1}));
  EXPECT_EQ(points.at(1, 1.25), (PointScatterer{{1, 0, 0}, 0.75}));
  EXPECT_EQ(points.at(1, 2), (PointScatterer{{4, 0, 0}, 0}));
  EXPECT_EQ(points.at(1, 3), (PointScatterer{{4, 4, 0}, -0.5}));
  EXPECT_EQ(points.at(1, 4), (PointScatterer{{4, 8, 0}, -1}));
  EXPECT_EQ(points.at(1, 100), (PointScatterer{{4, 8, 0}, -1}));
}

TEST(PointScatterers, KnowWhichMove) {
  const PointScatterers points = moving();
  EXPECT_TRUE(points.fixed(0));
  EXPECT_FALSE(points.fixed(1));
  EXPECT_FALSE(points.all_fixed());
  PointScatterers still;
  still.add_track({{3, {{1, 0, 0}, 1}}});
  EXPECT_TRUE(still.all_fixed());
}

TEST(PointScatterers, RefuseTracksWithoutRisingTimes) {
  PointScatterers points;
  EXPECT_THROW(points.add_track({}), std::logic_error);
  EXPECT_THROW(points.add_track({{1, {}}, {1, {}}}), std::logic_error);
  EXPECT_TRUE(points.empty());
}

TEST(PointScatterers, OfAPhantomAreAddedToItsOwn) {
  const Phantom own = make_phantom({.name = "points"});
  const Phantom both = own.with(moving());
  ASSERT_EQ(both.scatterers().size(), own.scatterers().size() + 2);
  EXPECT_EQ(both.scatterers().at(0, 0), own.scatterers().at(0, 0));
  EXPECT_EQ(both.scatterers().at(own.scatterers().size() + 1, 1.25).amplitude, 0.75);
}

}  // namespace
}  // namespace wobblebench::phantoms
