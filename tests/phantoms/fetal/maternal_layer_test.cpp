// The mother's tissue lies between probe and uterus, as thick as asked, in its order.
#include "phantoms/fetal/maternal_layer.h"
#include "base/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <set>

#include "phantoms/grids.h"
#include "phantoms/truth.h"

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

// Materials met on the way from the face of the probe, and where each begins.
struct Met {
  std::string material;
  double from_m;
};
std::vector<Met> way_of(const Phantom& phantom, const glm::dvec3& origin, const glm::dvec3& along) {
  std::vector<openvdb::FloatGrid::ConstAccessor> grids;
  for (const auto& grid : phantom.grids().signed_distance) {
    grids.push_back(grid->getConstAccessor());
  }
  std::vector<Met> met;
  for (double range = 0; range < 60 * kMillimetre; range += 0.1 * kMillimetre) {
    const glm::dvec3 p = origin + range * along - phantom.suggested_position_m();
    MaterialIndex found = phantom.background();
    for (std::size_t i = 0; i < grids.size(); ++i) {
      const auto& grid = *phantom.grids().signed_distance[i];
      const auto ijk = openvdb::Coord::round(grid.worldToIndex(openvdb::Vec3d(p.x, p.y, p.z)));
      if (grids[i].getValue(ijk) < 0) found = phantom.surfaces()[i].inside;
    }
    const std::string& name = phantom.materials()[found].name;
    if (met.empty() || met.back().material != name) met.push_back({name, range});
  }
  return met;
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
  const auto met = way_of(phantom, origin, along);
  ASSERT_GE(met.size(), 4u);
  EXPECT_EQ(met[0].material, "skin");
  EXPECT_EQ(met[1].material, "fat");
  EXPECT_EQ(met[2].material, "muscle");
  EXPECT_EQ(met[3].material, "uterus_wall");
}

// Several tests look at it, and building it is what takes time.
const Phantom& usual_fetus() {
  static const Phantom phantom = fetus(22, 21, kVoxel);
  return phantom;
}

TEST(MaternalLayer, TissuesFollowEachOtherOnTheAxis) {
  const Phantom& phantom = usual_fetus();
  const auto met = way_of(phantom, {0, 0, 40 * kMillimetre}, {0, 0, 1});
  const char* names[] = {"skin", "fat", "muscle", "uterus_wall", "amniotic_fluid"};
  const double from_mm[] = {0, 2, 14, 22};
  ASSERT_EQ(met.size(), 5u);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(met[i].material, names[i]);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(met[i].from_m, from_mm[i] * kMillimetre, 0.6 * kVoxel);
  EXPECT_GE(met[4].from_m, 27 * kMillimetre - kVoxel)
      << "the wall of the uterus has its own thickness";
}

TEST(MaternalLayer, EverySticksWayLeadsThroughAllTissues) {
  const Phantom& phantom = usual_fetus();
  for (double theta : {-0.67, -0.4, 0.0, 0.35, 0.67}) {
    for (double phi : {-0.53, -0.25, 0.0, 0.3, 0.53}) expect_layers(phantom, theta, phi);
  }
}

TEST(MaternalLayer, InterfacesAreCurvedAndUneven) {
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
  // It falls back from the axis, as a bow of 128 mm would, give or take its waves of 1 mm.
  double least = 1, most = -1;
  for (double x = -40; x <= 40; x += 2) {
    const double bow = 22 * kMillimetre - x * x * kMillimetre / (2 * 128);
    const double off = end(x * kMillimetre, 0) - bow;
    EXPECT_LT(std::abs(off), 3.0 * kMillimetre) << x;
    least = std::min(least, off);
    most = std::max(most, off);
  }
  EXPECT_GT(most - least, 0.5 * kMillimetre) << "not a perfect bow";
  EXPECT_GT(std::abs(end(15 * kMillimetre, 0) - end(-15 * kMillimetre, 0)), 0.1 * kMillimetre)
      << "not mirror images";
}

TEST(MaternalLayer, NoneLeavesTheUterusAlone) {
  const Phantom phantom = fetus(0);
  EXPECT_EQ(phantom.surfaces().at(0).name, "cavity");
  const auto met = way_of(phantom, {0, 0, 40 * kMillimetre}, {0, 0, 1});
  EXPECT_EQ(met[0].material, "uterus_wall");
  EXPECT_EQ(met[1].material, "amniotic_fluid");
}

double depth_of_face(const Phantom& phantom) {
  const SurfaceFinder finder(phantom);
  const glm::dvec3 face = glm::dvec3(0, 0, 40 * kMillimetre) - phantom.suggested_position_m();
  const auto wall = finder.first_hit(face, {0, 0, 1}, 0, 0.2);
  if (!wall) return 0;
  const auto skin = finder.first_hit(face, {0, 0, 1}, wall->distance_m + 3 * kMillimetre, 0.2);
  return skin ? skin->distance_m : 0;
}

TEST(MaternalLayer, DefaultLeavesTheFaceAtItsDepth) {
  const PhantomOptions defaults;
  for (double weeks : {20.0, 30.0}) {
    const Phantom bare = fetus(0, weeks);
    const Phantom usual = fetus(defaults.maternal_layer_m / kMillimetre, weeks);
    EXPECT_GT(depth_of_face(usual), 59 * kMillimetre) << weeks;
    EXPECT_LT(depth_of_face(usual), 77 * kMillimetre) << weeks;
    EXPECT_LT(std::abs(depth_of_face(usual) - depth_of_face(bare)), 1 * kMillimetre) << weeks;
  }
  EXPECT_EQ(fetus(0).suggested_position_m(), usual_fetus().suggested_position_m());
}

TEST(MaternalLayer, ThickerLayersPushTheFetusDeeper) {
  const Phantom phantom = fetus(45, 21, kVoxel);
  const auto met = way_of(phantom, {0, 0, 40 * kMillimetre}, {0, 0, 1});
  ASSERT_EQ(met.size(), 5u);
  EXPECT_NEAR(met[3].from_m, 45 * kMillimetre, 0.6 * kMillimetre);
  EXPECT_NEAR(met[4].from_m, 50 * kMillimetre, 0.6 * kMillimetre) << "5 mm of uterus are left";
}

TEST(MaternalLayer, RefusesWhatVanishesBetweenVoxels) {
  PhantomOptions options;
  options.maternal_layer_m = 3 * kMillimetre;
  try {
    validate(options);
    FAIL();
  } catch (const InvalidPhantom& error) {
    EXPECT_STREQ(error.what(), "maternal_layer_mm = 3: must be 0 or at least 6");
  }
}

}  // namespace
}  // namespace wobblebench::phantoms
