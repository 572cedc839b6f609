// The maternal layer: order, thickness and shape of its tissues between probe and uterus.
#include "base/units.h"
#include "phantoms/fetal/fetal_surroundings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/truth.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

constexpr double kVoxel = 1 * kMillimetre;

Phantom fetus(double layer_mm, double weeks = 21, double voxel_m = 2 * kMillimetre) {
  PhantomOptions options;
  options.maternal_layer_m = layer_mm * kMillimetre;
  options.gestational_age_weeks = weeks;
  options.voxel_m = voxel_m;
  return make_phantom(options);
}

// A material along a ray from the face of the probe, and the range at which it begins.
struct Segment {
  std::string material;
  double from_m;
};
std::vector<Segment> segments_along(const Phantom& phantom,
                                    const glm::dvec3& origin,
                                    const glm::dvec3& along) {
  std::vector<FloatGrid::ConstAccessor> grids;
  for (const auto& grid : phantom.grids().signed_distance) {
    grids.push_back(grid->getConstAccessor());
  }
  std::vector<Segment> segments;
  for (double range = 0; range < 60 * kMillimetre; range += 0.1 * kMillimetre) {
    const glm::dvec3 p = origin + range * along - phantom.suggested_position_m();
    MaterialIndex found = phantom.background();
    for (std::size_t i = 0; i < grids.size(); ++i) {
      const auto& grid = *phantom.grids().signed_distance[i];
      const auto ijk = openvdb::Coord::round(grid.worldToIndex(openvdb::Vec3d(p.x, p.y, p.z)));
      if (grids[i].getValue(ijk) < 0) found = phantom.surfaces()[i].inside;
    }
    const std::string& name = phantom.materials()[found].name;
    if (segments.empty() || segments.back().material != name) segments.push_back({name, range});
  }
  return segments;
}

// A stick of the default probe, whose face is a torus: 40 mm in its plane, 27 mm across.
void expect_layers(const Phantom& phantom, double theta, double phi) {
  SCOPED_TRACE(std::to_string(theta) + " " + std::to_string(phi));
  const auto torus = [&](double r) {
    const double planar = r * std::cos(theta) - 13 * kMillimetre;
    return glm::dvec3(
        r * std::sin(theta), -planar * std::sin(phi), 13 * kMillimetre + planar * std::cos(phi));
  };
  const glm::dvec3 origin = torus(40 * kMillimetre);
  const glm::dvec3 along = glm::normalize(torus(41 * kMillimetre) - origin);
  const auto segments = segments_along(phantom, origin, along);
  ASSERT_GE(segments.size(), 4u);
  EXPECT_EQ(segments[0].material, "skin");
  EXPECT_EQ(segments[1].material, "fat");
  EXPECT_EQ(segments[2].material, "muscle");
  EXPECT_EQ(segments[3].material, "uterus_wall");
}

// Building is slow: shared by several tests.
const Phantom& usual_fetus() {
  static const Phantom phantom = fetus(22, 21, kVoxel);
  return phantom;
}

TEST(MaternalLayer, TissuesAreInOrderOnTheAxis) {
  const Phantom& phantom = usual_fetus();
  const auto segments = segments_along(phantom, {0, 0, 40 * kMillimetre}, {0, 0, 1});
  const char* names[] = {"skin", "fat", "muscle", "uterus_wall", "amniotic_fluid"};
  const double from_mm[] = {0, 2, 14, 22};
  ASSERT_EQ(segments.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(segments[i].material, names[i]);
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(segments[i].from_m, from_mm[i] * kMillimetre, 0.6 * kVoxel);
  EXPECT_GE(segments[4].from_m, 27 * kMillimetre - kVoxel) << "5 mm of uterine wall";
}

TEST(MaternalLayer, EveryStickPassesAllTissues) {
  const Phantom& phantom = usual_fetus();
  for (double theta : {-0.67, -0.4, 0.0, 0.35, 0.67}) {
    for (double phi : {-0.53, -0.25, 0.0, 0.3, 0.53}) expect_layers(phantom, theta, phi);
  }
}

TEST(MaternalLayer, InterfacesAreCurvedAndUndulating) {
  const MaternalLayer layer(22 * kMillimetre, {0, 0, 0});
  // Depth of the end of the muscle below the plane of the face, by bisection.
  const auto end = [&](double x, double y) {
    double low = 0, high = 30 * kMillimetre;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (layer.muscle({x, y, middle}) < 0 ? low : high) = middle;
    }
    return low;
  };
  EXPECT_NEAR(end(0, 0), 22 * kMillimetre, 1e-9);
  // An arc of radius 128 mm about the axis, plus an undulation of 1 mm.
  double least = 1, most = -1;
  for (double x = -40; x <= 40; x += 2) {
    const double arc = 22 * kMillimetre - x * x * kMillimetre / (2 * 128);
    const double off = end(x * kMillimetre, 0) - arc;
    EXPECT_LT(std::abs(off), 3.0 * kMillimetre) << x;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  EXPECT_GT(most - least, 0.5 * kMillimetre) << "not a perfect arc";
  EXPECT_GT(std::abs(end(15 * kMillimetre, 0) - end(-15 * kMillimetre, 0)), 0.1 * kMillimetre)
      << "not mirror images";
}

TEST(MaternalLayer, WithoutLayerTheUterusReachesTheProbe) {
  const Phantom phantom = fetus(0);
  EXPECT_EQ(phantom.surfaces().at(0).name, "cavity");
  const auto segments = segments_along(phantom, {0, 0, 40 * kMillimetre}, {0, 0, 1});
  EXPECT_EQ(segments[0].material, "uterus_wall");
  EXPECT_EQ(segments[1].material, "amniotic_fluid");
}

double depth_of_face(const Phantom& phantom) {
  const SurfaceFinder finder(phantom);
  const glm::dvec3 face = glm::dvec3(0, 0, 40 * kMillimetre) - phantom.suggested_position_m();
  const auto wall = finder.first_hit(face, {0, 0, 1}, 0, 0.2);
  if (!wall) return 0;
  const auto skin = finder.first_hit(face, {0, 0, 1}, wall->distance_m + 3 * kMillimetre, 0.2);
  return skin ? skin->distance_m : 0;
}

TEST(MaternalLayer, DefaultKeepsTheDepthOfTheFace) {
  const PhantomOptions defaults;
  for (double weeks : {20.0, 30.0}) {
    const Phantom bare = fetus(0, weeks);
    const Phantom usual = fetus(defaults.maternal_layer_m / kMillimetre, weeks);
    EXPECT_GT(depth_of_face(usual), 59 * kMillimetre) << weeks;
    EXPECT_LT(depth_of_face(usual), 77 * kMillimetre) << weeks;
    EXPECT_LT(std::abs(depth_of_face(usual) - depth_of_face(bare)), 1.5 * kMillimetre) << weeks;
  }
  EXPECT_EQ(fetus(0).suggested_position_m(), usual_fetus().suggested_position_m());
}

TEST(MaternalLayer, ThickerLayersMoveTheFetusDeeper) {
  const Phantom phantom = fetus(45, 21, kVoxel);
  const auto segments = segments_along(phantom, {0, 0, 40 * kMillimetre}, {0, 0, 1});
  ASSERT_EQ(segments.size(), 5u);
  EXPECT_NEAR(segments[3].from_m, 45 * kMillimetre, 0.6 * kMillimetre);
  EXPECT_NEAR(segments[4].from_m, 50 * kMillimetre, 0.6 * kMillimetre) << "5 mm of uterus are left";
}

TEST(MaternalLayer, RefusesLayersThinnerThanVoxelsResolve) {
  PhantomOptions options;
  options.maternal_layer_m = 3 * kMillimetre;
  EXPECT_EQ(refusal_of<InvalidPhantom>([&] { validate(options); }),
            "maternal_layer_mm = 3: must be 0 or at least 6");
}

}  // namespace
}  // namespace wobblebench::phantoms
