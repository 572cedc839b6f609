// Import of triangle meshes: the bodies that they enclose, and the refusals.
#include <gtest/gtest.h>
#include <openvdb/tools/LevelSetMeasure.h>
#include <sys/stat.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "base/units.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/truth.h"
#include "tests/phantoms/io/meshes.h"
#include "tests/support/bytes_of.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

double volume_of(const TriangleMesh& mesh) {
  return enclosed_volume(shells_of(mesh));
}

double volume_of(const Phantom& phantom) {
  return openvdb::tools::levelSetVolume(*phantom.grids().signed_distance.at(0));
}

// Volume by which trilinear interpolation at 0.5 mm voxels may round off the twelve edges of a
// cube.
double edge_loss(double side_mm) {
  return 12 * side_mm * 0.25 * std::pow(kMillimetre, 3) * 0.7;
}

class MeshImport : public testing_support::FolderTest {
 protected:
  PhantomOptions options(const std::string& name) const {
    PhantomOptions o;
    o.name = "mesh";
    o.file = file(name).string();
    return o;
  }
  Phantom import(const std::string& name) const { return make_phantom(options(name)); }

  static std::string refusal(const PhantomOptions& o) {
    return refusal_of<InvalidPhantom>([&] { make_phantom(o); });
  }
  /// The message is one line that begins with the file and contains these words.
  void expect_refusal(const PhantomOptions& o, const std::string& words) const {
    const std::string line = refusal(o);
    EXPECT_EQ(line.rfind("file = \"" + o.file + "\": ", 0), 0u) << line;
    EXPECT_TRUE(holds(line, words));
    EXPECT_FALSE(holds(line, "\n"));
  }
  void expect_refusal(const TriangleMesh& mesh, const std::string& words) const {
    write_obj(mesh, file("faulty.obj"));
    expect_refusal(options("faulty.obj"), words);
  }
};

TEST_F(MeshImport, EveryFormatHoldsTheSameBody) {
  const TriangleMesh ball = icosphere(20, 4);
  write_obj(ball, file("ball.obj"));
  write_ascii_stl(ball, file("ascii.stl"));
  write_binary_stl(ball, file("binary.stl"));
  write_ascii_ply(ball, file("ascii.ply"));
  write_binary_ply(ball, file("binary.PLY"));
  const double truth = volume_of(ball) * std::pow(kMillimetre, 3);
  for (const char* name : {"ball.obj", "ascii.stl", "binary.stl", "ascii.ply", "binary.PLY"}) {
    SCOPED_TRACE(name);
    const Phantom phantom = import(name);
    EXPECT_EQ(phantom.name(), "mesh");
    EXPECT_NEAR(volume_of(phantom) / truth, 1, 1e-3);
    const auto& grid = *phantom.grids().signed_distance.at(0);
    EXPECT_EQ(grid.getGridClass(), openvdb::GRID_LEVEL_SET);
    EXPECT_NEAR(grid.voxelSize()[0], 0.5 * kMillimetre, 1e-12);
    EXPECT_NEAR(grid.background(), 4 * 0.5 * kMillimetre, 1e-9);
  }
}

TEST_F(MeshImport, SurfaceLiesOnTheTriangles) {
  const double radius = 20 * kMillimetre;
  const TriangleMesh ball = icosphere(20, 5);
  write_binary_stl(ball, file("ball.stl"));
  const SurfaceFinder finder(import("ball.stl"));
  // Triangles lie inside the ball by up to their sagitta.
  const double sagitta = radius * (1 - std::cos(0.6 * 63.4 / 32 * std::acos(-1.0) / 180));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const auto hit = finder.first_hit(-0.1 * direction, direction, 0, 0.1);
    ASSERT_TRUE(hit);
    ASSERT_GT(hit->distance_m, 0.1 - radius - 0.02 * kMillimetre);
    ASSERT_LT(hit->distance_m, 0.1 - radius + sagitta + 0.02 * kMillimetre);
    ASSERT_GT(glm::dot(hit->normal, -direction), std::cos(0.06));
  }
}

TEST_F(MeshImport, FlatFacesStayFlat) {
  write_ascii_ply(cube_mesh(30), file("cube.ply"));
  write_obj(tetrahedron(40), file("tetrahedron.obj"));
  const SurfaceFinder cube(import("cube.ply")), tetra(import("tetrahedron.obj"));
  for (double x = -13; x <= 13; x += 2.3) {
    const auto hit = cube.first_hit({x * kMillimetre, 4.1 * kMillimetre, -0.05}, {0, 0, 1}, 0, 0.1);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance_m, 35 * kMillimetre, 1e-6);
    EXPECT_LT(glm::distance(hit->normal, {0, 0, -1}), 1e-3);
  }
  // About its middle the tetrahedron's slanting face is x + y + z = 40 - 60 mm, seen from behind.
  const auto hit = tetra.first_hit({-8 * kMillimetre, -7 * kMillimetre, 0.08}, {0, 0, -1}, 0, 0.2);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, (80 - (-20 + 8 + 7)) * kMillimetre, 0.02 * kMillimetre);
  EXPECT_LT(glm::distance(hit->normal, glm::normalize(glm::dvec3(1))), 0.01);
}

TEST_F(MeshImport, IsCentredBelowTheProbe) {
  write_obj(moved(cube_mesh(30), {-1000, 2000, 500}), file("far.obj"));
  const Phantom phantom = import("far.obj");
  const SurfaceFinder finder(phantom);
  const glm::dvec3 face = glm::dvec3(0, 0, 40 * kMillimetre) - phantom.suggested_position_m();
  const auto hit = finder.first_hit(face, {0, 0, 1}, 0, 0.2);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 65 * kMillimetre, 0.01 * kMillimetre);
  const Box& box = phantom.region_of_interest();
  EXPECT_NEAR(box.low.z, -25 * kMillimetre, 0.01 * kMillimetre) << "it starts in the fluid";
  EXPECT_NEAR(box.high.x, 20 * kMillimetre, 0.01 * kMillimetre);
}

TEST_F(MeshImport, AMaterialLibraryThatIsAFifoIsNotWaitedFor) {
  write_obj(cube_mesh(30), file("cube.obj"));
  std::ofstream(file("fifo.obj")) << "mtllib fifo.mtl\n" << std::ifstream(file("cube.obj")).rdbuf();
  ASSERT_EQ(::mkfifo(file("fifo.mtl").c_str(), 0600), 0);
  EXPECT_NEAR(volume_of(import("fifo.obj")), 27e-6, edge_loss(30));
}

TEST_F(MeshImport, TakesUnitAndMaterials) {
  write_obj(cube_mesh(3), file("centimetres.obj"));
  PhantomOptions o = options("centimetres.obj");
  o.unit_m = 10 * kMillimetre;
  o.materials = {"muscle"};
  o.background = "water";
  o.target = false;
  const Phantom phantom = make_phantom(o);
  EXPECT_NEAR(volume_of(phantom), 27e-6, edge_loss(30));
  ASSERT_EQ(phantom.surfaces().size(), 1u);
  EXPECT_EQ(phantom.surfaces()[0].name, "centimetres");
  EXPECT_EQ(phantom.materials()[phantom.surfaces()[0].inside].name, "muscle");
  EXPECT_EQ(phantom.materials()[phantom.background()].name, "water");
  EXPECT_FALSE(phantom.surfaces()[0].is_target);
}

TEST_F(MeshImport, MergesTheMeshesOfAFile) {
  // One closed surface in two groups, each of them open.
  const TriangleMesh cube = cube_mesh(30);
  write_obj(cube, file("cube.obj"));
  std::ifstream in(file("cube.obj"));
  std::ofstream out(file("groups.obj"));
  int faces = 0;
  for (std::string line; std::getline(in, line);) {
    if (line[0] == 'f' && faces++ % 6 == 0) out << "g part" << faces << "\n";
    out << line << "\n";
  }
  out.close();
  EXPECT_NEAR(volume_of(import("groups.obj")), 27e-6, edge_loss(30));
  // Two bodies side by side.
  write_obj(joined(cube, moved(cube, {40, 0, 0})), file("two.obj"));
  EXPECT_NEAR(volume_of(import("two.obj")), 54e-6, 2 * edge_loss(30));
}

TEST_F(MeshImport, TriangulatesPolygons) {
  std::ofstream(file("quads.obj"))
      << "v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 20\nv 20 0 20\nv 20 20 20\nv 0 20 20\n"
      << "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  EXPECT_NEAR(volume_of(import("quads.obj")), 8e-6, edge_loss(20));
}

/// A prism with a Z for its caps: two rectangles that share a part of an edge.
TEST_F(MeshImport, ConcaveCapsLeaveNoSurfaceBesideTheBody) {
  std::ofstream(file("z.obj"))
      << "v -24 -12 -12\nv 0 -12 -12\nv 0 -4 -12\nv 24 -4 -12\nv 24 12 -12\nv -8 12 -12\n"
      << "v -8 -4 -12\nv -24 -4 -12\nv -24 -12 12\nv 0 -12 12\nv 0 -4 12\nv 24 -4 12\n"
      << "v 24 12 12\nv -8 12 12\nv -8 -4 12\nv -24 -4 12\nf 8 7 6 5 4 3 2 1\n"
      << "f 9 10 11 12 13 14 15 16\nf 1 2 10 9\nf 2 3 11 10\nf 3 4 12 11\nf 4 5 13 12\n"
      << "f 5 6 14 13\nf 6 7 15 14\nf 7 8 16 15\nf 8 1 9 16\n";
  const Phantom phantom = import("z.obj");
  EXPECT_NEAR(volume_of(phantom), 24 * (24 * 8 + 32 * 16) * 1e-9, 2 * edge_loss(30));
  const SurfaceFinder finder(phantom);
  const auto distance = [](double at, double low, double high) {  // beyond the ends
    return std::max({low - at, at - high, 0.0});
  };
  for (double x = -30; x <= 30; x += 0.7) {
    for (double y = -15; y <= 15; y += 0.7) {
      const double lower = std::hypot(distance(x, -24, 0), distance(y, -12, -4));
      const double upper = std::hypot(distance(x, -8, 24), distance(y, -4, 12));
      const double beside = std::min(lower, upper);
      if (beside > 0 && beside < 1) continue;
      const auto hit = finder.first_hit({x * 1e-3, y * 1e-3, -0.05}, {0, 0, 1}, 0, 0.1);
      ASSERT_EQ(hit.has_value(), beside == 0) << x << " " << y;
    }
  }
}

/// Volumes of balls by 4/3 pi r^3.
TEST_F(MeshImport, AnInnerShellThatFacesInwardsIsACavity) {
  const auto ball = [](double radius_mm) {
    return 4 * std::acos(-1.0) / 3 * std::pow(radius_mm * kMillimetre, 3);
  };
  const TriangleMesh hollow =
      joined(icosphere(20, 4), moved(inverted(icosphere(12, 4)), {3, 0, 0}));
  write_binary_stl(hollow, file("hollow.stl"));
  const Phantom shell = import("hollow.stl");
  EXPECT_NEAR(volume_of(shell) / (ball(20) - ball(12)), 1, 5e-3);
  const auto& grid = *shell.grids().signed_distance[0];
  const auto at = [&](double x_mm) {
    const auto index = grid.worldToIndex({x_mm * kMillimetre, 0, 0});
    return grid.tree().getValue(openvdb::Coord::round(index));
  };
  EXPECT_GT(at(3), 0);
  EXPECT_LT(at(-15), 0);
  EXPECT_GT(at(21.5), 0);

  write_obj(joined(hollow, moved(icosphere(5, 4), {2, 1, 0})), file("three.obj"));
  EXPECT_NEAR(volume_of(import("three.obj")) / (ball(20) - ball(12) + ball(5)), 1, 5e-3);
  // Beside it a body with two cavities.
  const TriangleMesh cheese =
      joined(joined(icosphere(15, 4), moved(inverted(icosphere(5, 4)), {-7, 0, 0})),
             moved(inverted(icosphere(4, 4)), {7, 1, 2}));
  write_obj(joined(hollow, moved(cheese, {50, 0, 0})), file("several.obj"));
  EXPECT_NEAR(
      volume_of(import("several.obj")) / (ball(20) - ball(12) + ball(15) - ball(5) - ball(4)),
      1,
      5e-3);
}

TEST_F(MeshImport, CornersThatDifferInTheirLastBitsAreOne) {
  const TriangleMesh ball = icosphere(20, 3);
  std::mt19937 random(3);
  for (const glm::dvec3 center : {glm::dvec3(0), {3000, -500, 7}}) {
    TriangleMesh soup;
    for (const auto& t : ball.triangles) {
      const auto first = std::uint32_t(soup.vertices.size());
      for (const std::uint32_t corner : t) {
        glm::dvec3 at = ball.vertices[corner] + center;
        for (int axis = 0; axis < 3; ++axis) {
          const float nearest = float(at[axis]);
          at[axis] = double(random() % 2 == 0 ? nearest : std::nextafter(nearest, 1e9f));
        }
        soup.vertices.push_back(at);
      }
      soup.triangles.push_back({first, first + 1, first + 2});
    }
    write_binary_stl(soup, file("last_bits.stl"));
    EXPECT_NEAR(volume_of(import("last_bits.stl")) / volume_of(ball) * 1e9, 1, 2e-3);
  }
  // A gap of a micrometre is one.
  TriangleMesh open = cube_mesh(30);
  open.vertices.push_back(open.vertices[7] + glm::dvec3(1e-3, 0, 0));
  open.triangles.back()[1] = 8;
  expect_refusal(open, "is not a closed surface");
}

TEST_F(MeshImport, TextureCoordinatesAreNoCorners) {
  const TriangleMesh ball = icosphere(20, 3);
  for (const bool first : {false, true}) {
    std::ofstream out(file("texture.ply"));
    const std::string corners = "property list uchar int vertex_indices\n";
    const std::string texture = "property list uchar float texcoord\n";
    out << "ply\nformat ascii 1.0\nelement vertex " << ball.vertices.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
        << ball.triangles.size() << "\n"
        << (first ? texture + corners : corners + texture) << "end_header\n";
    for (const auto& v : ball.vertices) out << v.x << " " << v.y << " " << v.z << "\n";
    for (const auto& t : ball.triangles) {
      const std::string wrapped = "6 -0.2 1.5 2 0 0.5 9000";
      const std::string face =
          "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]);
      out << (first ? wrapped + " " + face : face + " " + wrapped) << "\n";
    }
    out.close();
    EXPECT_NEAR(volume_of(import("texture.ply")) / volume_of(ball) * 1e9, 1, 2e-3) << first;
  }
}

class StlImport : public MeshImport {
 protected:
  static std::string binary(const TriangleMesh& mesh, const std::filesystem::path& path) {
    write_binary_stl(mesh, path);
    return testing_support::bytes_of(path);
  }
  void write(const std::string& bytes) const {
    std::ofstream(file("a.stl"), std::ios::binary | std::ios::trunc) << bytes;
  }
  static std::string with_count(std::string bytes, std::uint32_t count) {
    std::memcpy(bytes.data() + 80, &count, sizeof count);
    return bytes;
  }
  void expect_ball(const std::string& bytes, const std::string& what) const {
    write(bytes);
    EXPECT_NEAR(volume_of(import("a.stl")) / volume_of(ball_) * 1e9, 1, 2e-3) << what;
  }
  const TriangleMesh ball_ = icosphere(20, 3);
};

TEST_F(StlImport, BytesBehindTheLastTriangleAreLeftOut) {
  const std::string bytes = binary(ball_, file("ball.stl"));
  for (const std::size_t more : {1, 2, 49}) expect_ball(bytes + std::string(more, 'x'), "trailing");
  expect_ball(bytes + std::string(50, '\0'), "filled up");
}

TEST_F(StlImport, ABinaryHeaderMayBeginWithSolid) {
  std::string bytes = binary(ball_, file("ball.stl"));
  bytes.replace(0, 11, "solid head ");
  expect_ball(bytes, "exact");
  expect_ball(bytes + "\r\n", "trailing");
  expect_ball(with_count(bytes, 0), "no count");
}

TEST_F(StlImport, ACountThatWasNotFilledInIsFoundByTheLength) {
  const std::string bytes = binary(ball_, file("ball.stl"));
  for (const std::uint32_t count : {0u, 0xffffffffu, 1279u, 1u}) {
    expect_ball(with_count(bytes, count), std::to_string(count));
  }
}

TEST_F(StlImport, RefusesWhatCountAndLengthDoNotExplain) {
  const std::string bytes = binary(ball_, file("ball.stl"));
  const auto expect_contradiction = [&](const std::string& contents) {
    write(contents);
    expect_refusal(options("a.stl"), "its header counts ");
    expect_refusal(options("a.stl"), "it is cut off or damaged, or other data follow");
  };
  expect_contradiction(with_count(bytes, 1281));
  expect_contradiction(bytes.substr(0, bytes.size() - 50));
  expect_contradiction(bytes.substr(0, bytes.size() - 1));
  expect_contradiction(bytes + bytes);  // two files joined
  expect_contradiction(bytes + std::string(100, 'x'));
  write("solid but no more");
  expect_refusal(options("a.stl"), "STL: it ends too early");
}

TEST_F(StlImport, TextMayHoldSeveralSolidsWithAnyNames) {
  write_ascii_stl(ball_, file("a.stl"));
  const std::string one = testing_support::bytes_of(file("a.stl"));
  write_ascii_stl(moved(ball_, {50, 0, 0}), file("a.stl"));
  std::string two = testing_support::bytes_of(file("a.stl"));
  two.replace(0, 10, "  SOLID facet vertex 7");
  write(two + one);
  EXPECT_NEAR(volume_of(import("a.stl")) / volume_of(ball_) * 1e9, 2, 4e-3);
  write(one.substr(0, one.rfind("endsolid")));
  expect_refusal(options("a.stl"), "STL: it ends too early");
}

TEST_F(MeshImport, SameBytesAtAnyThreadCount) {
  write_obj(icosphere(20, 3), file("ball.obj"));
  const auto build = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return import("ball.obj");
  };
  const Phantom one = build(1), many = build(4);
  const auto &a = *one.grids().signed_distance[0], &b = *many.grids().signed_distance[0];
  ASSERT_EQ(a.activeVoxelCount(), b.activeVoxelCount());
  const auto other = b.getConstAccessor();
  for (auto voxel = a.cbeginValueAll(); voxel; ++voxel) {
    ASSERT_EQ(*voxel, other.getValue(voxel.getCoord()));
  }
}

TEST_F(MeshImport, IsWrittenAndReadAsAPhantom) {
  write_obj(icosphere(20, 3), file("ball.obj"));
  const Phantom phantom = import("ball.obj");
  write_phantom(phantom, file("ball.vdb"));
  EXPECT_DOUBLE_EQ(volume_of(read_phantom(file("ball.vdb"))), volume_of(phantom));
}

TEST_F(MeshImport, RefusesOtherFiles) {
  expect_refusal(options("missing.obj"), "no such file");
  std::ofstream(file("empty.stl")).close();
  expect_refusal(options("empty.stl"), "(it is empty)");
  expect_refusal(options(""), "");
  std::ofstream(file("picture.png")) << "not a mesh";
  expect_refusal(options("picture.png"), "must be an .obj, .stl or .ply");
  for (const char* name : {"text.obj", "text.stl", "text.ply"}) {
    std::ofstream(file(name)) << "Three lines\nof text,\nnot a mesh.\n";
    EXPECT_NE(refusal(options(name)), "") << name;
    expect_refusal(options(name), "");
  }
  PhantomOptions nameless = options("x");
  nameless.file = "";
  EXPECT_EQ(refusal(nameless), "file = \"\": must be the path of an .obj, .stl or .ply");
}

TEST_F(MeshImport, RefusesTruncatedFiles) {
  write_binary_stl(icosphere(20, 2), file("cut.stl"));
  write_binary_ply(icosphere(20, 2), file("cut.ply"));
  for (const char* name : {"cut.stl", "cut.ply"}) {
    const auto whole = std::filesystem::file_size(file(name));
    for (int tenth = 9; tenth > 0; --tenth) {
      std::filesystem::resize_file(file(name), whole * tenth / 10);
      EXPECT_NE(refusal(options(name)), "") << name << " " << tenth;
    }
  }
}

TEST_F(MeshImport, RefusesFilesWithoutTriangles) {
  std::ofstream(file("points.ply"))
      << "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      << "property float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
  expect_refusal(options("points.ply"), "");
  std::ofstream(file("lines.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n";
  expect_refusal(options("lines.obj"), "has no triangles");
}

TEST_F(MeshImport, RefusesOpenMeshesAndSaysHowManyEdges) {
  TriangleMesh open = cube_mesh(30);
  open.triangles.pop_back();
  expect_refusal(open, "is not a closed surface: 3 edges are not shared by exactly two triangles");
  // Two cubes that share an edge: four triangles meet there.
  expect_refusal(joined(cube_mesh(30), moved(cube_mesh(30), {30, 30, 0})),
                 "1 edges are not shared by exactly two triangles");
}

TEST_F(MeshImport, RefusesWrongOrientation) {
  expect_refusal(inverted(icosphere(20, 2)),
                 "is turned inside out: 1 of 1 shells have a negative volume");
  TriangleMesh one = cube_mesh(30);
  std::swap(one.triangles[4][0], one.triangles[4][1]);
  expect_refusal(one, "has triangles that face opposite ways at 3 edges");
  expect_refusal(joined(icosphere(20, 2), moved(inverted(icosphere(10, 2)), {40, 0, 0})),
                 "is turned inside out: 1 of 2 shells");
}

TEST_F(MeshImport, RefusesNestedAndIntersectingSurfaces) {
  expect_refusal(joined(icosphere(20, 3), icosphere(10, 3)),
                 "1 of 2 shells lie within another and face outwards as it does");
  expect_refusal(
      joined(joined(icosphere(20, 3), inverted(icosphere(14, 3))), inverted(icosphere(8, 3))),
      "is turned inside out: 1 of 3 shells");
  expect_refusal(joined(icosphere(20, 3), moved(icosphere(20, 3), {15, 0, 0})), "crosses itself");
}

TEST_F(MeshImport, RefusesNumbersThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = icosphere(20, 1);
    mesh.vertices[5].y = bad;
    write_binary_stl(mesh, file("bad.stl"));
    expect_refusal(options("bad.stl"), "holds a vertex that is not finite");
    write_binary_ply(mesh, file("bad.ply"));
    expect_refusal(options("bad.ply"), "holds a vertex that is not finite");
  }
}

TEST_F(MeshImport, RefusesSizesOutOfRange) {
  const TriangleMesh leaf{{{0, 0, 0}, {30, 0, 0}, {0, 30, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  expect_refusal(leaf, "encloses no volume");
  expect_refusal(cube_mesh(501), "measures 501 x 501 x 501 mm, more than 500: is unit_mm right?");
  expect_refusal(cube_mesh(1.5), "measures 1.5 x 1.5 x 1.5 mm, less than 4 voxels of 0.5 mm");
}

TEST_F(MeshImport, RefusesTooMuchMemory) {
  write_binary_stl(icosphere(249, 5), file("large.stl"));
  PhantomOptions o = options("large.stl");
  o.voxel_m = 0.1 * kMillimetre;
  expect_refusal(o, "would take about ");
  expect_refusal(o, " GB of memory; at most 4 GB are allowed: voxel_mm must be larger");
}

TEST_F(MeshImport, RefusesUnknownMaterials) {
  write_obj(cube_mesh(30), file("cube.obj"));
  PhantomOptions o = options("cube.obj");
  o.materials = {"unknown"};
  EXPECT_EQ(refusal(o).rfind("materials = \"unknown\": must be one of water, amniotic_fluid, ", 0),
            0u);
  o.materials = {"fat", "muscle"};
  EXPECT_EQ(refusal(o), "materials = 2 names: takes one name for a mesh");
  o.materials = {"fat"};
  o.background = "vacuum";
  EXPECT_EQ(refusal(o).rfind("background = \"vacuum\": must be one of water, ", 0), 0u);
  o.background = "water";
  o.unit_m = 0;
  EXPECT_EQ(refusal(o), "unit_mm = 0: must be within 0.001 and 10000");
}

}  // namespace
}  // namespace wobblebench::phantoms
