#include "phantoms/import/polygon.h"

#include <GL/glu.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace wobblebench::phantoms {
namespace {

using Corners = std::span<const glm::dvec3>;
using Triangle = TriangleMesh::Triangle;
using Triangles = std::vector<Triangle>;

/// Lengths below this part of a face's size are the rounding of its corners to floats.
constexpr double kRounding = 1e-6;

[[noreturn]] void refuse(const glm::dvec3& corner) {
  std::ostringstream reason;
  reason << "has a face whose outline crosses or touches itself, with a corner at (" << corner.x
         << ", " << corner.y << ", " << corner.z << "): cut it into triangles";
  throw std::invalid_argument(reason.str());
}

/// Twice the area of a triangle as a vector along its normal.
glm::dvec3 area2(Corners corners, const Triangle& t) {
  return glm::cross(corners[t[1]] - corners[t[0]], corners[t[2]] - corners[t[0]]);
}

/// All triangles at one corner.
Triangles fan(std::uint32_t first, std::size_t size) {
  const auto count = static_cast<std::uint32_t>(size);
  Triangles triangles;
  for (std::uint32_t i = 1; i + 1 < count; ++i) {
    triangles.push_back({first, (first + i) % count, (first + i + 1) % count});
  }
  return triangles;
}

/// Shape and direction of a face.
struct Plane {
  glm::dvec3 normal{0};  ///< twice the area along the normal (Newell)
  double unsigned2 = 0;  ///< twice the area of the first corner's triangles, whatever they face
  double size = 0;       ///< largest distance from the first corner
};

Plane plane_of(Corners corners) {
  Plane plane;
  for (const Triangle& triangle : fan(0, corners.size())) {
    const glm::dvec3 area = area2(corners, triangle);
    plane.normal += area;
    plane.unsigned2 += glm::length(area);
  }
  for (const glm::dvec3& corner : corners) {
    plane.size = std::max(plane.size, glm::distance(corner, corners[0]));
  }
  return plane;
}

double least_area(Corners corners, const Triangles& triangles, const glm::dvec3& direction) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles) {
    least = std::min(least, glm::dot(area2(corners, t), direction));
  }
  return least;
}

/// By the diagonal at the first corner, as most programs do, unless it lies outside.
Triangles cut_quadrilateral(Corners corners, const glm::dvec3& direction) {
  const Triangles at_first = fan(0, 4), at_second = fan(1, 4);
  const double first = least_area(corners, at_first, direction);
  return first > 0 || first >= least_area(corners, at_second, direction) ? at_first : at_second;
}

/// What GLU's callbacks fill. They must not throw: it is a C library.
struct Cut {
  Corners corners;
  double rounding;                       ///< length
  std::vector<std::uint32_t> corner_of;  ///< three a triangle
  bool failed = false;
};

void on_vertex(void* corner, void* data) {
  Cut& cut = *static_cast<Cut*>(data);
  if (corner == nullptr || cut.corner_of.size() == cut.corner_of.capacity()) {
    cut.failed = true;
    return;
  }
  cut.corner_of.push_back(
      static_cast<std::uint32_t>(static_cast<const glm::dvec3*>(corner) - cut.corners.data()));
}

/// Where edges meet: at a corner, or the outline crosses itself.
void on_combine(GLdouble at[3], void* given[4], GLfloat*, void** result, void* data) {
  Cut& cut = *static_cast<Cut*>(data);
  *result = given[0];
  for (int i = 0; i < 4 && given[i] != nullptr; ++i) {
    const glm::dvec3& corner = *static_cast<const glm::dvec3*>(given[i]);
    if (glm::distance(corner, {at[0], at[1], at[2]}) > cut.rounding) continue;
    *result = given[i];
    return;
  }
  cut.failed = true;
}

void on_error(GLenum, void* data) {
  static_cast<Cut*>(data)->failed = true;
}

/// With this callback GLU makes triangles alone: no fans and strips.
void on_edge_flag(GLboolean) {}

using Callback = void (*)();

/// GLU's sweep (Mesa's libGLU), of the face seen along the axis nearest to its normal.
Triangles cut_by_sweep(Corners corners, const glm::dvec3& axis, double rounding) {
  Cut cut{corners, rounding, {}};
  cut.corner_of.reserve(3 * corners.size());
  const std::unique_ptr<GLUtesselator, decltype(&gluDeleteTess)> sweep(gluNewTess(), gluDeleteTess);
  if (!sweep) throw std::bad_alloc();
  gluTessCallback(sweep.get(), GLU_TESS_VERTEX_DATA, reinterpret_cast<Callback>(on_vertex));
  gluTessCallback(sweep.get(), GLU_TESS_COMBINE_DATA, reinterpret_cast<Callback>(on_combine));
  gluTessCallback(sweep.get(), GLU_TESS_ERROR_DATA, reinterpret_cast<Callback>(on_error));
  gluTessCallback(sweep.get(), GLU_TESS_EDGE_FLAG, reinterpret_cast<Callback>(on_edge_flag));
  gluTessProperty(sweep.get(), GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_POSITIVE);
  gluTessNormal(sweep.get(), axis.x, axis.y, axis.z);
  gluTessBeginPolygon(sweep.get(), &cut);
  gluTessBeginContour(sweep.get());
  for (const glm::dvec3& corner : corners) {
    std::array<GLdouble, 3> at{corner.x, corner.y, corner.z};
    gluTessVertex(sweep.get(), at.data(), const_cast<glm::dvec3*>(&corner));
  }
  gluTessEndContour(sweep.get());
  gluTessEndPolygon(sweep.get());
  Triangles triangles;
  if (cut.failed) return triangles;
  for (std::size_t i = 0; i + 2 < cut.corner_of.size(); i += 3) {
    triangles.push_back({cut.corner_of[i], cut.corner_of[i + 1], cut.corner_of[i + 2]});
  }
  return triangles;
}

/// For each corner the first one at its position.
std::vector<std::uint32_t> first_at_position(Corners corners) {
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  std::vector<std::uint32_t> first;
  for (const glm::dvec3& corner : corners) {
    const auto next = static_cast<std::uint32_t>(first.size());
    first.push_back(known.try_emplace({corner.x, corner.y, corner.z}, next).first->second);
  }
  return first;
}

/// Whether the edges of the triangles are those of the outline, once edges that run both ways
/// cancel. Together with areas of one sign it says that the triangles cover the face without a
/// fold: as many lie over a point as the outline winds about it.
bool has_outline(Corners corners, const Triangles& triangles) {
  const std::vector<std::uint32_t> first = first_at_position(corners);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> runs;
  const auto add = [&](std::size_t from, std::size_t to, int count) {
    const std::uint32_t a = first[from], b = first[to];
    if (a != b) runs[std::minmax(a, b)] += a < b ? count : -count;
  };
  for (std::size_t i = 0; i < corners.size(); ++i) add(i, (i + 1) % corners.size(), 1);
  for (const Triangle& t : triangles) {
    for (int corner = 0; corner < 3; ++corner) add(t[corner], t[(corner + 1) % 3], -1);
  }
  return std::all_of(runs.begin(), runs.end(), [](const auto& run) { return run.second == 0; });
}

/// The axis nearest to the normal, towards its side.
glm::dvec3 nearest_axis(const glm::dvec3& normal) {
  int nearest = 0;
  for (const int axis : {1, 2}) {
    if (std::abs(normal[axis]) > std::abs(normal[nearest])) nearest = axis;
  }
  glm::dvec3 direction(0);
  direction[nearest] = normal[nearest] < 0 ? -1 : 1;
  return direction;
}

}  // namespace

Triangles cut_polygon(Corners corners) {
  const Plane plane = plane_of(corners);
  const double flat = kRounding * plane.size * plane.size;
  // Corners that are not finite are refused with the mesh.
  if (corners.size() == 3 || !(plane.unsigned2 > flat)) return fan(0, corners.size());
  if (glm::length(plane.normal) <= flat) refuse(corners[0]);
  const bool four = corners.size() == 4;
  const glm::dvec3 direction = four ? glm::normalize(plane.normal) : nearest_axis(plane.normal);
  Triangles triangles = four ? cut_quadrilateral(corners, direction)
                             : cut_by_sweep(corners, direction, kRounding * plane.size);
  if (triangles.empty() || least_area(corners, triangles, direction) < -flat ||
      !has_outline(corners, triangles)) {
    refuse(corners[0]);
  }
  return triangles;
}

void add_face(TriangleMesh& mesh, std::span<const std::uint32_t> corners) {
  std::vector<glm::dvec3> at;
  for (const std::uint32_t corner : corners) at.push_back(mesh.vertices[corner]);
  for (const Triangle& t : cut_polygon(at)) {
    mesh.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
  }
}

}  // namespace wobblebench::phantoms
