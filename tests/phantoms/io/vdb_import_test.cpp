// Import of level sets of other programs: the phantoms made of them, and the refusals.
#include <gtest/gtest.h>
#include <openvdb/io/File.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

#include "base/units.h"
#include "phantoms/float_grid.h"
#include "phantoms/framing.h"
#include "phantoms/grids.h"
#include "phantoms/truth.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

using Grid = FloatGrid;

// A ball in the file's unit, made by OpenVDB, with a band of three voxels.
Grid::Ptr ball(const std::string& name,
               double radius,
               const glm::dvec3& center = glm::dvec3(0),
               double voxel = 0.5) {
  auto grid = openvdb::tools::createLevelSetSphere<Grid>(
      float(radius),
      openvdb::Vec3f(float(center.x), float(center.y), float(center.z)),
      float(voxel));
  grid->setName(name);
  return grid;
}

class VdbImport : public testing_support::FolderTest {
 protected:
  void SetUp() override { openvdb::initialize(); }

  PhantomOptions options() const {
    PhantomOptions o;
    o.name = "vdb";
    o.file = file("foreign.vdb").string();
    return o;
  }
  void write(const openvdb::GridCPtrVec& grids) const {
    openvdb::io::File(options().file).write(grids);
  }

  static std::string refusal(const PhantomOptions& o) {
    return refusal_of<InvalidPhantom>([&] { make_phantom(o); });
  }
  void expect_refusal(const std::string& words) const {
    const std::string line = refusal(options());
    EXPECT_EQ(line.rfind("file = \"" + options().file + "\": ", 0), 0u) << line;
    EXPECT_TRUE(holds(line, words));
    EXPECT_FALSE(holds(line, "\n"));
  }
};

TEST_F(VdbImport, TakesEveryLevelSetInMetres) {
  auto fog = ball("fog", 10);
  openvdb::tools::sdfToFogVolume(*fog);
  write({ball("head", 20, {100, -50, 300}),
         fog,
         ball("eye", 5, {105, -50, 290}),
         openvdb::GridBase::createGrid(openvdb::Int32Grid::gridType())});
  PhantomOptions o = options();
  o.materials = {"fetal_skin", "vitreous"};
  o.background = "water";
  o.targets = {"head"};
  const Phantom phantom = make_phantom(o);
  EXPECT_EQ(phantom.name(), "vdb");
  ASSERT_EQ(phantom.surfaces().size(), 2u);
  EXPECT_EQ(phantom.surfaces()[0].name, "head");
  EXPECT_EQ(phantom.surfaces()[1].name, "eye");
  EXPECT_EQ(phantom.materials()[phantom.surfaces()[0].inside].name, "fetal_skin");
  EXPECT_EQ(phantom.materials()[phantom.surfaces()[1].inside].name, "vitreous");
  EXPECT_EQ(phantom.materials()[phantom.background()].name, "water");
  EXPECT_TRUE(phantom.surfaces()[0].is_target);
  EXPECT_FALSE(phantom.surfaces()[1].is_target);
  const auto& grids = phantom.grids().signed_distance;
  EXPECT_NEAR(
      openvdb::tools::levelSetVolume(*grids[0]) / (4 * std::acos(-1.0) / 3 * 8e-6), 1, 2e-3);
  EXPECT_NEAR(grids[0]->background(), 1.5 * kMillimetre, 1e-9);
  EXPECT_NEAR(grids[0]->voxelSize()[0], 0.5 * kMillimetre, 1e-12);
}

TEST_F(VdbImport, IsCentredBelowTheProbe) {
  write({ball("ball", 20, {100, -50, 300})});
  const Phantom phantom = make_phantom(options());
  const SurfaceFinder finder(phantom);
  const glm::dvec3 face = glm::dvec3(0, 0, 40 * kMillimetre) - phantom.suggested_position_m();
  const auto hit = finder.first_hit(face, {0, 0, 1}, 0, 0.2);
  ASSERT_TRUE(hit);
  // The bounding box of the negative voxels is up to a voxel smaller than the ball.
  EXPECT_NEAR(hit->distance_m, 65 * kMillimetre, 0.501 * kMillimetre);
  for (double x = -15; x <= 15; x += 3.1) {
    const auto hit_here = finder.first_hit({x * kMillimetre, 0, -0.05}, {0, 0, 1}, 0, 0.1);
    ASSERT_TRUE(hit_here);
    const double half = std::sqrt(400 - x * x);
    EXPECT_NEAR(hit_here->distance_m, (50 - half) * kMillimetre, 0.06 * kMillimetre * 20 / half);
  }
}

/// Two balls: the front of the turned pair is that of the nearer one.
TEST_F(VdbImport, TurnedItLiesWithItsFrontBelowTheProbe) {
  const glm::dvec3 small_mm(30, -10, 40);
  write({ball("large", 20), ball("small", 8, small_mm)});
  const Phantom phantom = make_phantom(options());
  // The bounding box reaches from -20 to 38, 20 and 48 mm.
  const glm::dvec3 middle_mm(9, 0, 14);
  for (const glm::dvec3 degrees :
       {glm::dvec3(180, 0, 0), {0, 90, 0}, {0, -90, 0}, {25, 130, -60}}) {
    const glm::dmat3 rotation = rotation_xyz(degrees * kDegree);
    const double front_mm =
        std::min((rotation * -middle_mm).z - 20, (rotation * (small_mm - middle_mm)).z - 8);
    const Framing framing = phantoms::framing(phantom, rotation);
    EXPECT_NEAR(framing.position_m.z, (105 - front_mm) * kMillimetre, 0.501 * kMillimetre);
    EXPECT_NEAR(
        framing.region_of_interest.low.z, (front_mm - 10) * kMillimetre, 0.501 * kMillimetre);
  }
}

TEST_F(VdbImport, TakesTheUnitOfTheFile) {
  write({ball("ball", 0.02, {}, 0.0005)});
  PhantomOptions o = options();
  o.unit_m = 1;
  const Phantom phantom = make_phantom(o);
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*phantom.grids().signed_distance[0]),
              4 * std::acos(-1.0) / 3 * 8e-6,
              0.1e-6);
}

TEST_F(VdbImport, TakesNamedGridsInTheirOrder) {
  write({ball("a", 20), ball("b", 10), ball("c", 5)});
  PhantomOptions o = options();
  o.grids = {"c", "a"};
  const Phantom phantom = make_phantom(o);
  ASSERT_EQ(phantom.surfaces().size(), 2u);
  EXPECT_EQ(phantom.surfaces()[0].name, "c");
  EXPECT_EQ(phantom.surfaces()[1].name, "a");
  EXPECT_EQ(phantom.surfaces()[0].inside, phantom.surfaces()[1].inside) << "one material for all";
  EXPECT_TRUE(phantom.surfaces()[0].is_target && phantom.surfaces()[1].is_target);
  o.target = false;
  EXPECT_FALSE(make_phantom(o).surfaces()[0].is_target);
}

TEST_F(VdbImport, GridsMayShareATree) {
  const Grid::Ptr first = ball("first", 20);
  const Grid::Ptr second = openvdb::gridPtrCast<Grid>(first->copyGrid());
  second->setName("second");
  write({first, second});
  const Phantom phantom = make_phantom(options());
  for (const auto& grid : phantom.grids().signed_distance) {
    EXPECT_NEAR(openvdb::tools::levelSetVolume(*grid), 33.51e-6, 0.1e-6);
  }
}

/// A box of 20 x 30 x 40 in the file's unit, its distances by the closed form, on a lattice with
/// these steps from a voxel to the next along each of its axes.
Grid::Ptr box_on_lattice(const glm::dmat3& steps, const glm::dvec3& origin) {
  const Grid::Ptr grid = create_level_set(1, 1.5);
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) matrix(row, axis) = steps[row][axis];
    matrix(3, row) = origin[row];
  }
  grid->setTransform(std::make_shared<openvdb::math::Transform>(
      openvdb::math::MapBase::Ptr(new openvdb::math::AffineMap(matrix))));
  grid->setName("box");
  auto tree = grid->getAccessor();
  const glm::dvec3 half(10, 15, 20);
  for (const auto& c : openvdb::CoordBBox::createCube(openvdb::Coord(-60), 121)) {
    const glm::dvec3 at = origin + steps * glm::dvec3(c.x(), c.y(), c.z());
    const glm::dvec3 beyond = glm::abs(at) - half;
    const double inside = std::min(std::max({beyond.x, beyond.y, beyond.z}), 0.0);
    const double distance = glm::length(glm::max(beyond, glm::dvec3(0))) + inside;
    if (std::abs(distance) < 1.5) tree.setValue(c, float(distance));
  }
  openvdb::tools::signedFloodFill(grid->tree());
  return grid;
}

/// Where the phantom's surface lies on the axes, from its centre.
glm::dvec3 half_sizes(const Phantom& phantom) {
  const SurfaceFinder finder(phantom);
  glm::dvec3 half(0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 direction(0);
    direction[axis] = 1;
    const auto ahead = finder.first_hit(-0.1 * direction, direction, 0, 0.2);
    const auto back = finder.first_hit(0.1 * direction, -direction, 0, 0.2);
    if (ahead && back) half[axis] = (0.2 - ahead->distance_m - back->distance_m) / 2;
  }
  return half;
}

TEST_F(VdbImport, SwappedAndMirroredAxesAreTheBodyAsItLies) {
  const glm::dvec3 right(10e-3, 15e-3, 20e-3);
  const glm::dvec3 x(0.5, 0, 0), y(0, 0.5, 0), z(0, 0, 0.5);
  for (const glm::dmat3& steps :
       {glm::dmat3(x, y, z), {y, x, z}, {z, x, y}, {-x, y, z}, {-z, -y, -x}}) {
    write({box_on_lattice(steps, {0.1, 0.2, -0.1})});
    const Phantom phantom = make_phantom(options());
    EXPECT_LT(glm::distance(half_sizes(phantom), right), 0.02 * kMillimetre)
        << steps[0].x << " " << steps[0].y << " " << steps[0].z;
    EXPECT_NEAR(openvdb::tools::levelSetVolume(*phantom.grids().signed_distance[0]), 24e-6, 0.1e-6);
  }
}

TEST_F(VdbImport, RefusesTurnedAndShearedAxes) {
  const double turned = 0.5 * std::sqrt(0.5);
  write({box_on_lattice({{turned, turned, 0}, {-turned, turned, 0}, {0, 0, 0.5}}, {})});
  expect_refusal(
      "grid \"box\" lies on turned axes: the x axis of its voxels points along (0.707, "
      "0.707, 0); resample it onto axes along x, y and z");
  write({box_on_lattice({{0.5, 0, 0}, {0, turned, turned}, {0, turned, -turned}}, {})});
  expect_refusal("the y axis of its voxels points along (0, 0.707, 0.707)");
  write({box_on_lattice({{0.5, 0, 0}, {0.1, 0.5, 0}, {0, 0, 0.5}}, {})});
  expect_refusal("grid \"box\" does not have cubic voxels");
  write({box_on_lattice({{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, -0.6}}, {})});
  expect_refusal("grid \"box\" does not have cubic voxels");
}

/// Two balls of radius 8, 20 apart, each with the origin of its lattice in its middle.
TEST_F(VdbImport, OriginsMayDifferByWholeVoxels) {
  const auto ball_at = [](const std::string& name, double x) {
    const Grid::Ptr grid = ball(name, 8);
    grid->transform().postTranslate({x, 0, 0});
    return grid;
  };
  write({ball_at("left", -10), ball_at("right", 10)});
  const Phantom phantom = make_phantom(options());
  const SurfaceFinder finder(phantom);
  for (const double x_mm : {-10.0, 10.0}) {
    const auto hit = finder.first_hit({x_mm * kMillimetre, 0, -0.05}, {0, 0, 1}, 0, 0.1);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance_m, 42 * kMillimetre, 0.3 * kMillimetre);
  }
  EXPECT_FALSE(finder.first_hit({0, 0, -0.05}, {0, 0, 1}, 0, 0.1));
  const auto& grids = phantom.grids().signed_distance;
  EXPECT_EQ(grids[0]->transform(), grids[1]->transform());
  for (const auto& grid : grids) {
    EXPECT_NEAR(
        openvdb::tools::levelSetVolume(*grid) / (4 * std::acos(-1.0) / 3 * 512e-9), 1, 1e-2);
  }
  write({ball_at("left", -10), ball_at("right", 10.25)});
  expect_refusal("grid \"right\" has other voxels than \"left\", (-0.5, 0, 0) voxels beside them");
}

TEST_F(VdbImport, TakesGridsOfDoubles) {
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::DoubleGrid>(20, {0, 0, 0}, 0.5);
  grid->setName("ball");
  write({grid});
  EXPECT_NEAR(openvdb::tools::levelSetVolume(*make_phantom(options()).grids().signed_distance[0]),
              4 * std::acos(-1.0) / 3 * 8e-6,
              0.1e-6);
}

TEST_F(VdbImport, RestoresTheSignFarInside) {
  const Grid::Ptr grid = ball("ball", 20);
  for (auto tile = grid->beginValueOff(); tile; ++tile) tile.setValue(grid->background());
  write({grid});
  const Phantom phantom = make_phantom(options());
  const auto& inside = *phantom.grids().signed_distance[0];
  EXPECT_LT(inside.tree().getValue(openvdb::Coord::round(inside.worldToIndex({0, 0, 0}))), 0);
}

TEST_F(VdbImport, IsWrittenAndReadAsAPhantom) {
  write({ball("ball", 20, {3, 4, 5})});
  const Phantom phantom = make_phantom(options());
  write_phantom(phantom, file("ours.vdb"));
  const Phantom read = read_phantom(file("ours.vdb"));
  const auto &a = *phantom.grids().signed_distance[0], &b = *read.grids().signed_distance[0];
  EXPECT_EQ(a.transform(), b.transform());
  EXPECT_EQ(a.activeVoxelCount(), b.activeVoxelCount());
  openvdb::io::File in(file("ours.vdb").string());
  in.open();
  const auto materials = openvdb::gridPtrCast<FloatGrid>(in.readGrid("material"));
  const auto middle = openvdb::Coord::round(materials->worldToIndex({0, 0, 0}));
  EXPECT_EQ(int(materials->tree().getValue(middle)), material_index("soft_tissue"));
}

TEST_F(VdbImport, TakesOurOwnFilesAsLevelSets) {
  PhantomOptions sphere;
  sphere.name = "sphere";
  write_phantom(make_phantom(sphere),
                options().file);  // written as a stream, without grid offsets
  PhantomOptions o = options();
  const std::string millimetres = refusal(o);
  EXPECT_EQ(millimetres.rfind("name = \"vdb\": " + o.file + " is a phantom that this program", 0),
            0u);
  EXPECT_TRUE(holds(millimetres, "name = \"file\" reads it"));
  o.unit_m = 1;
  const Phantom phantom = make_phantom(o);
  EXPECT_EQ(phantom.surfaces().at(0).name, "ball");
}

TEST_F(VdbImport, RefusesOtherFiles) {
  expect_refusal("no such file");
  std::ofstream(options().file) << "a text, long enough to hold a header";
  expect_refusal("not a readable OpenVDB file");
  std::ofstream(options().file, std::ios::trunc).close();
  expect_refusal("not readable as a .vdb (it is empty)");
}

TEST_F(VdbImport, RefusesEveryTruncation) {
  for (const bool seekable : {true, false}) {
    if (seekable) {
      write({ball("ball", 20)});
    } else {
      std::ofstream out(options().file, std::ios::binary);
      openvdb::io::Stream(out).write(openvdb::GridCPtrVec{ball("ball", 20)});
    }
    const auto whole = std::filesystem::file_size(options().file);
    for (int tenth = 9; tenth >= 0; --tenth) {
      std::filesystem::resize_file(options().file, whole * tenth / 10);
      EXPECT_NE(refusal(options()), "") << tenth << " tenths";
    }
  }
}

TEST_F(VdbImport, RefusesGridsWithoutASurface) {
  const Grid::Ptr empty = create_level_set(1.0, 1.5);
  empty->setName("nothing");
  write({empty});
  expect_refusal("grid \"nothing\" is empty");
  const Grid::Ptr outside = ball("outside", 20);
  for (auto value = outside->beginValueAll(); value; ++value)
    value.setValue(std::abs(*value) + 0.01f);
  write({outside});
  EXPECT_NE(refusal(options()), "");
}

TEST_F(VdbImport, RefusesValuesThatAreNoDistances) {
  const Grid::Ptr nan = ball("nan", 20);
  nan->tree().setValue({40, 0, 0}, std::numeric_limits<float>::quiet_NaN());
  write({nan});
  expect_refusal("grid \"nan\" holds a value that is not finite");

  const Grid::Ptr voxels = ball("voxels", 20);  // distances in voxels, positions in millimetres
  for (auto value = voxels->beginValueAll(); value; ++value) value.setValue(2 * *value);
  voxels->tree().root().setBackground(3, false);
  write({voxels});
  expect_refusal("grid \"voxels\" does not hold distances in the unit of its voxels");

  auto thin = openvdb::tools::createLevelSetSphere<Grid>(20, {0, 0, 0}, 0.5, 1.2f);
  thin->setName("thin");
  write({thin});
  expect_refusal("grid \"thin\" has a narrow band of less than 1.5 voxels");
}

TEST_F(VdbImport, RefusesOtherClassesTypesAndVoxels) {
  auto fog = ball("fog", 20);
  openvdb::tools::sdfToFogVolume(*fog);
  const auto ids = openvdb::GridBase::createGrid(openvdb::Int32Grid::gridType());
  ids->setName("ids");
  write({fog, ids});
  expect_refusal("holds no level set, but fog (float fog volume), ids (int32 unknown)");

  PhantomOptions o = options();
  o.grids = {"fog"};
  EXPECT_TRUE(holds(refusal(o), "grid \"fog\" is not of the class level set"));
  o.grids = {"ids"};
  EXPECT_TRUE(holds(refusal(o), "grid \"ids\" holds int32, not float or double"));

  const Grid::Ptr slab = ball("slab", 20);
  slab->setTransform(std::make_shared<openvdb::math::Transform>(
      openvdb::math::MapBase::Ptr(new openvdb::math::ScaleMap({0.5, 0.5, 1}))));
  write({slab});
  expect_refusal("grid \"slab\" does not have cubic voxels");

  write({ball("fine", 20), ball("coarse", 20, {}, 1.0)});
  expect_refusal("grid \"coarse\" has other voxels than \"fine\"");
  write({ball("same", 20), ball("same", 10)});
  EXPECT_NE(refusal(options()), "");
}

TEST_F(VdbImport, RefusesUnknownGridsMaterialsAndTargets) {
  write({ball("head", 20), ball("eye", 5)});
  PhantomOptions o = options();
  o.grids = {"heart"};
  EXPECT_EQ(refusal(o),
            "grids = \"heart\": no such grid; the file holds head (float level set), "
            "eye (float level set)");
  o = options();
  o.materials = {"unknown"};
  EXPECT_EQ(refusal(o).rfind("materials = \"unknown\": must be one of water, amniotic_fluid, ", 0),
            0u);
  o.materials = {"fat", "fat", "muscle"};
  EXPECT_EQ(refusal(o), "materials = 3 names: takes 1, or one for each of head, eye");
  o = options();
  o.targets = {"nose"};
  EXPECT_EQ(refusal(o), "targets = \"nose\": must be among the grids: head, eye");
  write({ball("bad\nname", 20)});
  expect_refusal("not printable UTF-8");
}

TEST_F(VdbImport, RefusesSizesOutOfRange) {
  write({ball("ball", 260, {}, 5)});
  expect_refusal("more than 500: is unit_mm right?");
  PhantomOptions metres = options();
  metres.unit_m = 1;
  EXPECT_TRUE(holds(refusal(metres), "more than 500: is unit_mm right?"));
  write({ball("ball", 2.4, {}, 1.5)});
  expect_refusal("less than 4 voxels of 1.5 mm");
}

TEST_F(VdbImport, RefusesVoxelsOfAWrongUnit) {
  write({ball("ball", 0.02, {}, 0.0005)});
  expect_refusal("grid \"ball\" has voxels of 0.0005 mm, less than 0.05 mm: is unit_mm right?");
}

TEST_F(VdbImport, RefusesTooMuchMemoryBeforeReading) {
  const Grid::Ptr grid = ball("ball", 20);
  openvdb::io::File out(options().file);
  out.setGridStatsMetadataEnabled(false);  // or OpenVDB would overwrite the entry
  grid->insertMeta(openvdb::GridBase::META_FILE_MEM_BYTES, openvdb::Int64Metadata(7'500'000'000));
  out.write(openvdb::GridCPtrVec{grid});
  expect_refusal("would take about 7.5 GB of memory; at most 4 GB are allowed");
}

}  // namespace
}  // namespace wobblebench::phantoms
