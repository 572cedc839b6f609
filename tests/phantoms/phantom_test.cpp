#include "phantoms/phantom.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>

#include "phantoms/fetal/face_measures.h"
#include "phantoms/fetal/head_solver.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/truth.h"
#include "tests/support/expect.h"

namespace wobblebench::phantoms {
namespace {

// Material at a position: that of the last surface that contains it.
std::string material_at(const Phantom& phantom, const glm::dvec3& position) {
  MaterialIndex found = phantom.background();
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const auto& grid = *phantom.grids().signed_distance[i];
    const auto ijk = openvdb::Coord::round(
        grid.worldToIndex(openvdb::Vec3d(position.x, position.y, position.z)));
    if (grid.tree().getValue(ijk) < 0) found = phantom.surfaces()[i].inside;
  }
  return phantom.materials()[found].name;
}

std::string refusal(const PhantomOptions& options) {
  return refusal_of<InvalidPhantom>([&] { make_phantom(options); });
}

// By validate(), without building.
std::string refusal_by_validate(const PhantomOptions& options) {
  return refusal_of<InvalidPhantom>([&] { validate(options); });
}

TEST(Placement, TransformsAreInverse) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return glm::dvec3(number(random), number(random), number(random)); };
  for (int i = 0; i < 100; ++i) {
    const Placement placement{rotation_xyz(3.0 * vector()), vector()};
    const glm::dvec3 p = vector();
    EXPECT_LT(glm::distance(placement.to_phantom(placement.to_probe(p)), p), 1e-14);
    const glm::dvec3 q = vector();
    const glm::dvec3 difference = placement.to_probe(q) - placement.to_probe(p);
    EXPECT_LT(glm::distance(placement.direction_to_probe(q - p), difference), 1e-14);
    EXPECT_LT(glm::distance(placement.direction_to_phantom(difference), q - p), 1e-14);
  }
}

TEST(Rotation, TurnsAboutXThenYThenZ) {
  constexpr double kQuarter = std::numbers::pi / 2;
  const auto near = [](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::distance(a, b) < 1e-14;
  };
  EXPECT_TRUE(near(rotation_xyz({kQuarter, 0, 0}) * glm::dvec3(0, 1, 0), {0, 0, 1}));
  EXPECT_TRUE(near(rotation_xyz({0, kQuarter, 0}) * glm::dvec3(0, 0, 1), {1, 0, 0}));
  EXPECT_TRUE(near(rotation_xyz({0, 0, kQuarter}) * glm::dvec3(1, 0, 0), {0, 1, 0}));
  EXPECT_TRUE(near(rotation_xyz({kQuarter, kQuarter, 0}) * glm::dvec3(0, 1, 0), {1, 0, 0}));
}

TEST(MakePhantom, BuildsEveryName) {
  for (const std::string& name : phantom_names()) {
    PhantomOptions options;
    options.name = name;
    options.voxel_m = 1.5e-3;
    const Phantom phantom = make_phantom(options);
    SCOPED_TRACE(name);
    EXPECT_EQ(phantom.name(), name);
    const Box& box = phantom.region_of_interest();
    EXPECT_TRUE(box.low.x < box.high.x && box.low.y < box.high.y && box.low.z < box.high.z);
    const double front_m = phantom.surfaces().empty() ? 0 : 20e-3;
    EXPECT_GT(phantom.suggested_position_m().z + box.low.z, 40e-3 + front_m)
        << "in front of the probe";
    EXPECT_EQ(phantom.scatterers().empty(), !phantom.surfaces().empty());
    for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
      EXPECT_GT(phantom.grids().signed_distance[i]->activeVoxelCount(), 100u);
    }
  }
}

TEST(MakePhantom, RefusalsStateKeyValueAndAllowedRange) {
  PhantomOptions options;
  options.name = "unknown";
  EXPECT_EQ(refusal(options),
            "name = \"unknown\": must be one of fetal_face, plane, steps, sphere, points, cyst, "
            "bone_plate, "
            "speckle_block, mesh, vdb, file");
  options = {};
  options.gestational_age_weeks = 19;
  EXPECT_EQ(refusal(options), "gestational_age_weeks = 19: must be within 20 and 34");
  options.gestational_age_weeks = std::nan("");
  EXPECT_NE(refusal(options), "");
  options = {};
  options.voxel_m = 0;
  EXPECT_EQ(refusal(options), "voxel_mm = 0: must be within 0.1 and 5");
  options.voxel_m = 3e-3;
  EXPECT_EQ(refusal(options), "voxel_mm = 3: must be at most 2 for the phantom fetal_face");
  options = {};
  options.name = "file";
  EXPECT_EQ(refusal(options), "file = \"\": must be the path of a .vdb");
}

TEST(ValidatePhantom, RefusesWhatMakePhantomRefuses) {
  PhantomOptions unknown, old, coarse, unnamed, missing, folder;
  unknown.name = "unknown";
  old.gestational_age_weeks = 99;
  coarse.name = "sphere";
  coarse.radius_m = 5e-3;
  coarse.voxel_m = 4e-3;
  unnamed.name = missing.name = folder.name = "file";
  missing.file = "no/such.vdb";
  folder.file = "/";
  for (const auto& options : {unknown, old, coarse, unnamed, missing, folder}) {
    EXPECT_NE(refusal_by_validate(options), "");
    EXPECT_EQ(refusal_by_validate(options), refusal(options));
  }
  EXPECT_EQ(refusal_by_validate(coarse),
            "voxel_mm = 4: must be at most 2.5 for the phantom sphere");
  EXPECT_EQ(refusal_by_validate(missing), "file = \"no/such.vdb\": no such file");
  EXPECT_EQ(refusal_by_validate({}), "");
}

TEST(MakePhantom, PlaneCrossesItsWholeBox) {
  for (double tilt_deg : {0.0, 20.0, -40.0}) {
    PhantomOptions options;
    options.name = "plane";
    options.tilt_x_rad = tilt_deg * std::numbers::pi / 180;
    options.voxel_m = 1e-3;
    const Phantom phantom = make_phantom(options);
    const SurfaceFinder finder(phantom);
    const Box& box = phantom.region_of_interest();
    for (double x : {box.low.x, 0.0, box.high.x}) {
      for (double y : {box.low.y, 0.0, box.high.y}) {
        EXPECT_TRUE(finder.first_hit({x, y, box.low.z}, {0, 0, 1}, 0, box.high.z - box.low.z));
        EXPECT_EQ(material_at(phantom, {x, y, box.low.z}), "amniotic_fluid");
      }
    }
  }
}

// The grid of a surface by its name.
const FloatGrid& grid_of(const Phantom& phantom, const std::string& name) {
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    if (phantom.surfaces()[i].name == name) return *phantom.grids().signed_distance[i];
  }
  throw std::logic_error("no surface " + name);
}

class FetalScene : public testing::TestWithParam<double> {
 protected:
  void SetUp() override {
    PhantomOptions options;
    options.gestational_age_weeks = GetParam();
    options.voxel_m = 1e-3;
    auto& built = built_[GetParam()];
    if (built == nullptr) built = std::make_unique<Phantom>(make_phantom(options));
    phantom_ = built.get();
  }
  // Building is slow: one phantom per age, shared by all tests.
  static inline std::map<double, std::unique_ptr<Phantom>> built_;
  const Phantom* phantom_ = nullptr;
};

TEST_P(FetalScene, BoxStartsInTheFluid) {
  const Box& box = phantom_->region_of_interest();
  for (double u = 0; u <= 1; u += 0.05) {
    for (double v = 0; v <= 1; v += 0.05) {
      const glm::dvec3 position{
          glm::mix(box.low.x, box.high.x, u), glm::mix(box.low.y, box.high.y, v), box.low.z};
      ASSERT_EQ(material_at(*phantom_, position), "amniotic_fluid") << u << " " << v;
    }
  }
}

TEST_P(FetalScene, MaternalTissueLiesBetweenProbeAndFluid) {
  const SurfaceFinder finder(*phantom_);
  const double face_z = 40e-3 - phantom_->suggested_position_m().z;
  const auto wall = finder.first_hit({0, 0, face_z}, {0, 0, 1}, 0, 0.2);
  ASSERT_TRUE(wall);
  EXPECT_EQ(phantom_->surfaces()[wall->surface].name, "cavity");
  // Overlying tissue: mean 29 mm, at least 17 mm (Carson 1989).
  EXPECT_GT(wall->distance_m, 20e-3);
  EXPECT_LT(wall->distance_m, 33e-3);
  const auto face = finder.first_hit({0, 0, face_z}, {0, 0, 1}, wall->distance_m + 3e-3, 0.2);
  ASSERT_TRUE(face);
  EXPECT_EQ(phantom_->surfaces()[face->surface].name, "skin");
  EXPECT_GT(face->distance_m - wall->distance_m, 14e-3);
  EXPECT_FALSE(finder.first_hit({0, 0, face_z}, {0, 0, 1}, 0, wall->distance_m - 1e-3))
      << "maternal interfaces are no targets";
}

TEST_P(FetalScene, FirstHitsLieOnTheSurfaces) {
  const SurfaceFinder finder(*phantom_);
  const Box& box = phantom_->region_of_interest();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1), slant(-0.25, 0.25);
  int hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 eye{glm::mix(box.low.x, box.high.x, share(random)),
                         glm::mix(box.low.y, box.high.y, share(random)),
                         box.low.z};
    const glm::dvec3 direction = glm::normalize(glm::dvec3(slant(random), slant(random), 1));
    const auto hit = finder.first_hit(eye, direction, 0, 0.3);
    ASSERT_TRUE(hit) << "the cavity is closed";
    const glm::dvec3 position = eye + hit->distance_m * direction;
    const auto gap = finder.distance(position);
    ASSERT_TRUE(gap);
    ASSERT_NEAR(gap->value_m, 0, 0.02e-3);
    hits += phantom_->surfaces()[hit->surface].name == "skin";
  }
  EXPECT_GT(hits, 1200) << "most of the box shows the fetus";
}

TEST_P(FetalScene, FetusAndCordLieWithinTheFluid) {
  const auto& cavity = grid_of(*phantom_, "cavity");
  for (const char* name : {"cord", "skin", "skull", "brain", "eyes"}) {
    for (auto voxel = grid_of(*phantom_, name).cbeginValueOn(); voxel; ++voxel) {
      if (*voxel >= 0) continue;
      ASSERT_LT(cavity.tree().getValue(voxel.getCoord()), 0) << name << " " << voxel.getCoord();
    }
  }
}

TEST_P(FetalScene, BoneLiesUnderSkinAndBrainUnderBone) {
  const auto inside_of = [&](const char* inner, const char* outer) {
    const auto& b = grid_of(*phantom_, outer);
    for (auto voxel = grid_of(*phantom_, inner).cbeginValueOn(); voxel; ++voxel) {
      if (*voxel > -0.25e-3) continue;
      ASSERT_LT(b.tree().getValue(voxel.getCoord()), 0);
    }
  };
  inside_of("skull", "skin");
  inside_of("brain", "skull");
  inside_of("eyes", "skin");
}

// Smallest and largest distance of a surface's voxels from the joint's centre.
std::pair<double, double> reach_from_joint(const Phantom& phantom, const std::string& name) {
  const auto& grid = grid_of(phantom, name);
  double nearest = 1, farthest = 0;
  for (auto voxel = grid.cbeginValueOn(); voxel; ++voxel) {
    if (*voxel > 0.5e-3 || *voxel < -0.5e-3) continue;
    const openvdb::Vec3d p = grid.indexToWorld(voxel.getCoord());
    const double d = glm::distance(glm::dvec3(p.x(), p.y(), p.z()), phantom.joint()->center_m);
    nearest = std::min(nearest, d);
    farthest = std::max(farthest, d);
  }
  return {nearest, farthest};
}

TEST_P(FetalScene, HeadTurnsWithoutTheWall) {
  ASSERT_TRUE(phantom_->joint());
  const Joint& joint = *phantom_->joint();
  EXPECT_LT(joint.inner_m, joint.outer_m);
  EXPECT_LT(reach_from_joint(*phantom_, "skull").second, joint.inner_m) << "bone turns rigidly";
  EXPECT_LT(reach_from_joint(*phantom_, "eyes").second, joint.inner_m);
  EXPECT_GT(reach_from_joint(*phantom_, "cavity").first, joint.outer_m) << "the wall rests";
}

TEST_P(FetalScene, HeadTurnMovesTheRestLittle) {
  const Joint& joint = *phantom_->joint();
  MotionOptions options;
  options.head_turn_rad = 10 * std::numbers::pi / 180;
  options.head_turn_period_s = 2;
  const Motion motion(options, joint);
  const double scale = face_unit_m(mean_face(GetParam())) / 1e-3;
  const auto moves = [&](const glm::dvec3& position_mm) {
    const glm::dvec3 position = 1e-3 * scale * position_mm;
    return glm::distance(motion.from_rest(position, 0.5), position) / scale;
  };
  EXPECT_GT(moves({0, 0, 0}), 5e-3) << "the face turns";
  // The middle of the hand, its knuckles, the chest and the shoulders; see fetal_surroundings.cpp.
  EXPECT_LT(moves({25.5, 24, 4}), 2e-3);
  EXPECT_LT(moves({23, 18, 0}), 4.5e-3);
  EXPECT_LT(moves({0, 56, 38}), 0.1e-3);
  EXPECT_LT(moves({26, 40, 40}), 0.1e-3);
}

// By calipers on the grid: up and down from the middle of the mouth, in the head's median plane.
TEST(OpenMouth, IsAsHighAsItsOptionSaysAndDarkBehindTheLips) {
  for (const double weeks : {21.0, 27.0}) {
    const Phantom phantom = make_phantom({.gestational_age_weeks = weeks, .mouth_open_m = 6e-3});
    const Mouth& mouth = phantom.joint()->mouth.value();
    const auto fluid_along = [&](const glm::dvec3& step, double behind_m = 0) {
      const glm::dvec3 from = mouth.center_m + behind_m * mouth.axes[2];
      double length = 0;
      while (length < 20e-3 && material_at(phantom, from + length * step) == "amniotic_fluid") {
        length += 0.1e-3;
      }
      return length;
    };
    const double height_m = fluid_along(mouth.axes[1]) + fluid_along(-mouth.axes[1]);
    EXPECT_NEAR(height_m, 6e-3, 1e-3) << weeks;
    EXPECT_GT(fluid_along(mouth.axes[2]), 5e-3) << "the oral cavity";
    EXPECT_LT(fluid_along(mouth.axes[0], 4e-3), 10e-3) << "it ends at the corners";
    EXPECT_LT(fluid_along(-mouth.axes[0], 4e-3), 10e-3);
  }
  EXPECT_FALSE(make_phantom({.voxel_m = 2e-3}).joint()->mouth);
}

TEST(OpenMouth, RefusalsStateWhatIsAllowed) {
  EXPECT_EQ(refusal({.mouth_open_m = 1e-3}), "mouth_open_mm = 1: must be 0 or at least 2");
  EXPECT_EQ(refusal({.voxel_m = 1e-3, .mouth_open_m = 2e-3}),
            "voxel_mm = 1: must be at most 0.5 for the phantom fetal_face");
  EXPECT_EQ(refusal({.mouth_open_m = 11e-3}), "mouth_open_mm = 11: must be within 0 and 10");
}

INSTANTIATE_TEST_SUITE_P(Weeks, FetalScene, testing::Values(20.0, 21.0, 25.5, 34.0));

}  // namespace
}  // namespace wobblebench::phantoms
