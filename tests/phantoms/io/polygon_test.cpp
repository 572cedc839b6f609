// Faces of many corners: random outlines, each in a plane of its own, are read from a file. The
// triangles must cover what an independent test of points finds inside, once, and nothing else.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "phantoms/io/triangle_mesh.h"
#include "phantoms/phantom.h"
#include "tests/support/expect.h"
#include "tests/support/folder_test.h"

namespace wobblebench::phantoms {
namespace {

using Point = glm::dvec2;
using Outline = std::vector<Point>;

double shoelace(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point &a = outline[i], &b = outline[(i + 1) % outline.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return twice / 2;
}

/// Number of edges to the right of the point, odd within the outline.
bool is_inside(const Outline& outline, const Point& p) {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point &a = outline[i], &b = outline[(i + 1) % outline.size()];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    inside ^= p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
  }
  return inside;
}

/// Cells that grow from one; the outline of those whose boundary is one loop without a repeated
/// corner. With `straight` also the lattice's corners along straight edges.
Outline rectilinear(std::mt19937& random, bool straight) {
  for (;;) {
    std::set<std::array<int, 2>> cells{{0, 0}};
    const std::size_t wanted = 3 + random() % 40;
    while (cells.size() < wanted) {
      auto cell = *std::next(cells.begin(), static_cast<long>(random() % cells.size()));
      cell[random() % 2] += random() % 2 == 0 ? 1 : -1;
      cells.insert(cell);
    }
    std::map<std::array<int, 2>, std::array<int, 2>> next;
    std::size_t edges = 0;
    for (const auto& [x, y] : cells) {
      const auto edge =
          [&](std::array<int, 2> beyond, std::array<int, 2> from, std::array<int, 2> to) {
            if (cells.contains(beyond)) return;
            next[from] = to;
            ++edges;
          };
      edge({x, y - 1}, {x, y}, {x + 1, y});
      edge({x + 1, y}, {x + 1, y}, {x + 1, y + 1});
      edge({x, y + 1}, {x + 1, y + 1}, {x, y + 1});
      edge({x - 1, y}, {x, y + 1}, {x, y});
    }
    std::vector<std::array<int, 2>> loop{next.begin()->first};
    while (next[loop.back()] != loop.front() && loop.size() <= edges) {
      loop.push_back(next[loop.back()]);
    }
    if (loop.size() != edges) continue;  // with a hole, or two cells that touch at a corner
    Outline outline;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto &before = loop[(i + loop.size() - 1) % loop.size()],
                 &after = loop[(i + 1) % loop.size()];
      const bool turns = before[0] != after[0] && before[1] != after[1];
      if (turns || straight) outline.emplace_back(loop[i][0], loop[i][1]);
    }
    return outline;
  }
}

/// A point a direction, at random distances from the middle.
Outline star_shaped(std::mt19937& random) {
  std::uniform_real_distribution<double> distance(0.3, 8);
  const int corners = 5 + static_cast<int>(random() % 40);
  Outline outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, r = distance(random);
    outline.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return outline;
}

class Polygons : public testing_support::FolderTest {
 protected:
  /// Triangles of each face, in its plane.
  using Faces = std::vector<std::vector<std::array<Point, 3>>>;

  /// Writes the outlines as faces of one file, each in a plane of its own, and reads them.
  Faces read(const std::vector<Outline>& outlines, const glm::dmat3& rotation) const {
    std::ofstream out(file("faces.obj"));
    out.precision(std::numeric_limits<float>::max_digits10);
    std::size_t vertices = 0;
    for (std::size_t i = 0; i < outlines.size(); ++i) {
      std::string face = "f";
      for (const Point& p : outlines[i]) {
        const glm::dvec3 at = rotation * glm::dvec3(p, double(i));
        out << "v " << at.x << " " << at.y << " " << at.z << "\n";
        face += ' ';
        face += std::to_string(++vertices);
      }
      out << face << "\n";
    }
    out.close();
    const TriangleMesh mesh = read_mesh(file("faces.obj"));
    Faces faces(outlines.size());
    for (const auto& triangle : mesh.triangles) {
      std::array<Point, 3> corners;
      double plane = 0;
      for (int i = 0; i < 3; ++i) {
        const glm::dvec3 at = glm::transpose(rotation) * mesh.vertices[triangle[i]];
        corners[i] = Point(at);
        plane += at.z / 3;
      }
      faces.at(static_cast<std::size_t>(std::lround(plane))).push_back(corners);
    }
    return faces;
  }

  static void expect_covered(const Outline& outline,
                             const std::vector<std::array<Point, 3>>& triangles,
                             std::mt19937& random) {
    double area = 0, area_without_sign = 0;
    for (const auto& t : triangles) {
      const double one = shoelace({t.begin(), t.end()});
      area += one;
      area_without_sign += std::abs(one);
    }
    ASSERT_NEAR(area, shoelace(outline), 0.01);
    ASSERT_NEAR(area_without_sign, area, 0.01) << "a fold";
    std::uniform_real_distribution<double> within(-9, 9);
    for (int i = 0; i < 60; ++i) {
      const Point p =
          outline[random() % outline.size()] + Point(within(random), within(random)) / 4.0;
      int over = 0;
      for (const auto& t : triangles) over += is_inside({t.begin(), t.end()}, p);
      ASSERT_EQ(over, is_inside(outline, p)) << p.x << " " << p.y;
    }
  }

  void expect_all_covered(const std::function<Outline(std::mt19937&)>& next) const {
    std::mt19937 random(35);
    for (const glm::dvec3 degrees :
         {glm::dvec3(0), {180, 0, 0}, {0, 90, 0}, {33, 71, 12}, {-50, 20, 160}}) {
      std::vector<Outline> outlines;
      for (int i = 0; i < 300; ++i) outlines.push_back(next(random));
      const Faces faces = read(outlines, rotation_xyz(degrees * std::numbers::pi / 180.0));
      for (std::size_t i = 0; i < outlines.size(); ++i) {
        SCOPED_TRACE(i);
        expect_covered(outlines[i], faces[i], random);
        if (HasFatalFailure()) return;
      }
    }
  }

  void expect_covered(const Outline& outline) const {
    std::mt19937 random(1);
    expect_covered(outline, read({outline}, glm::dmat3(1))[0], random);
  }
  void expect_refused(const Outline& outline) const {
    EXPECT_TRUE(holds(refusal_of<std::invalid_argument>([&] { read({outline}, glm::dmat3(1)); }),
                      "outline crosses or touches itself"));
  }
};

TEST_F(Polygons, RectilinearOnesAreCoveredOnce) {
  expect_all_covered([](std::mt19937& random) { return rectilinear(random, false); });
}

TEST_F(Polygons, CornersOnStraightEdgesAreKept) {
  std::mt19937 random(2);
  std::vector<Outline> outlines;
  for (int i = 0; i < 300; ++i) outlines.push_back(rectilinear(random, true));
  const Faces faces = read(outlines, glm::dmat3(1));
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_covered(outlines[i], faces[i], random)) << i;
    std::set<std::pair<double, double>> corners;
    for (const auto& t : faces[i]) {
      for (const Point& p : t) corners.emplace(p.x, p.y);
    }
    ASSERT_EQ(corners.size(), outlines[i].size()) << "the next face shares each of them";
  }
}

TEST_F(Polygons, StarShapedOnesAreCoveredOnce) {
  expect_all_covered(star_shaped);
}

TEST_F(Polygons, HolesMayBeJoinedByABridge) {
  // A square with a square hole: the edge between (0, 0) and (1, 1) runs both ways.
  const Outline ring{
      {0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {1, 1}, {1, 4}, {4, 4}, {4, 1}, {1, 1}};
  EXPECT_EQ(shoelace(ring), 36 - 9);
  expect_covered(ring);
}

TEST_F(Polygons, CornersMayBeThereTwice) {
  expect_covered({{0, 0}, {4, 0}, {4, 0}, {4, 4}, {2, 1}, {2, 1}, {0, 4}});
  expect_covered({{0, 0}, {2, 0}, {2, 2}, {4, 2}, {4, 4}, {2, 4}, {2, 2}, {0, 2}});  // two squares
}

TEST_F(Polygons, QuadrilateralsMayBeConcave) {
  for (int first = 0; first < 4; ++first) {
    Outline arrow{{0, 0}, {4, 4}, {0, 1}, {-4, 4}};
    std::rotate(arrow.begin(), arrow.begin() + first, arrow.end());
    expect_covered(arrow);
  }
}

TEST_F(Polygons, OutlinesThatCrossThemselvesAreRefused) {
  expect_refused({{0, 0}, {4, 4}, {4, 0}, {0, 4}});  // area 0
  expect_refused({{0, 0}, {4, 4}, {4, 0}, {0, 2}});
  expect_refused({{0, 0}, {6, 0}, {6, 6}, {2, -2}, {0, 6}});
  expect_refused({{0, 0}, {6, 0}, {6, 4}, {2, 4}, {2, -2}, {1, -2}, {1, 4}, {0, 4}});
  Outline pentagram;
  for (int i = 0; i < 5; ++i) {
    const double angle = 2 * std::numbers::pi * 2 * i / 5;
    pentagram.emplace_back(4 * std::cos(angle), 4 * std::sin(angle));
  }
  expect_refused(pentagram);  // winds twice about its middle
  const Outline once{{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}};
  Outline twice = once;
  twice.insert(twice.end(), once.begin(), once.end());
  expect_refused(twice);
}

TEST_F(Polygons, ACornerOnAnotherEdgeIsRefused) {
  expect_refused({{0, 0}, {6, 0}, {6, 4}, {4, 4}, {3, 0}, {2, 4}, {0, 4}});
}

TEST_F(Polygons, BentFacesAreCutWithoutAFold) {
  std::ofstream(file("bent.obj"))
      << "v 0 0 0\nv 4 0 0.5\nv 4 4 -0.5\nv 2 1 0.4\nv 0 4 0\nf 1 2 3 4 5\n";
  const TriangleMesh mesh = read_mesh(file("bent.obj"));
  ASSERT_EQ(mesh.triangles.size(), 3u);
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Outline seen{
        Point(mesh.vertices[t[0]]), Point(mesh.vertices[t[1]]), Point(mesh.vertices[t[2]])};
    EXPECT_GT(shoelace(seen), 0);
    area += shoelace(seen);
  }
  EXPECT_NEAR(area, 16 - 6, 1e-5);
}

TEST_F(Polygons, FacesWithoutAreaKeepTheirEdges) {
  std::ofstream(file("line.obj"))
      << "v 0 0 0\nv 1 1 1\nv 3 3 3\nv 2 2 2\nv 1.5 1.5 1.5\nf 1 2 3 4 5\n";
  EXPECT_EQ(read_mesh(file("line.obj")).triangles.size(), 3u);
}

}  // namespace
}  // namespace wobblebench::phantoms
