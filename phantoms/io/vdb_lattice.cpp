#include "phantoms/io/vdb_lattice.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "phantoms/float_grid.h"
#include "phantoms/refusal.h"

namespace wobblebench::phantoms {
namespace {

using openvdb::Vec3d;

/// In voxels: differences of this part come from rounding.
constexpr double kRounding = 1e-6;

[[noreturn]] void refuse(const FloatGrid& grid, const std::string& reason) {
  throw std::invalid_argument("grid " + quoted(grid.getName()) + " " + reason);
}

std::string shown(const Vec3d& v) {
  std::ostringstream text;
  text.precision(3);
  const auto rounded = [](double axis) { return std::round(axis * 1e6) / 1e6 + 0.0; };
  text << "(" << rounded(v.x()) << ", " << rounded(v.y()) << ", " << rounded(v.z()) << ")";
  return text.str();
}

/// Steps from a voxel to the next along each axis of a lattice.
std::array<Vec3d, 3> steps_of(const FloatGrid& grid) {
  const openvdb::Mat4d matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
  std::array<Vec3d, 3> steps;
  for (int i = 0; i < 3; ++i) steps[i] = {matrix(i, 0), matrix(i, 1), matrix(i, 2)};
  return steps;
}

bool are_cubes(const std::array<Vec3d, 3>& steps) {
  const double side = steps[0].length();
  for (int i = 0; i < 3; ++i) {
    if (!(std::abs(steps[i].length() - side) <= kRounding * side)) return false;
    if (!(std::abs(steps[i].dot(steps[(i + 1) % 3])) <= kRounding * side * side)) return false;
  }
  return side > 0;
}

/// Where a voxel of one lattice has its place on another.
struct Relocation {
  std::array<int, 3> axis{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};
  openvdb::Coord shift;

  openvdb::Coord operator()(const openvdb::Coord& from) const {
    openvdb::Coord to = shift;
    for (int i = 0; i < 3; ++i) to[axis[i]] += sign[i] * from[i];
    return to;
  }
};

Relocation relocation_of(const FloatGrid& grid, const std::array<Vec3d, 3>& steps) {
  constexpr std::array<const char*, 3> kNames{"x", "y", "z"};
  Relocation relocation;
  for (int i = 0; i < 3; ++i) {
    const Vec3d direction = steps[i].unit();
    int along = 0;
    for (const int axis : {1, 2}) {
      if (std::abs(direction[axis]) > std::abs(direction[along])) along = axis;
    }
    if (1 - std::abs(direction[along]) > kRounding * kRounding) {
      refuse(grid,
             std::string("lies on turned axes: the ") + kNames[i] + " axis of its voxels points " +
                 "along " + shown(direction) + "; resample it onto axes along x, y and z");
    }
    relocation.axis[i] = along;
    relocation.sign[i] = direction[along] < 0 ? -1 : 1;
  }
  return relocation;
}

FloatGrid::Ptr relocated(const FloatGrid& grid,
                         const Relocation& relocation,
                         const openvdb::math::Transform::Ptr& transform) {
  FloatGrid::Ptr result = create_level_set(1, double(grid.background()));
  result->setTransform(transform);
  result->setName(grid.getName());
  result->setGridClass(grid.getGridClass());
  auto tree = result->getAccessor();
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (!value.isVoxelValue()) refuse(grid, "holds one value for a block of voxels in its band");
    tree.setValue(relocation(value.getCoord()), *value);
  }
  openvdb::tools::signedFloodFill(result->tree());
  return result;
}

openvdb::math::Transform::Ptr lattice(double side, const Vec3d& origin) {
  auto transform = openvdb::math::Transform::createLinearTransform(side);
  transform->postTranslate(origin);
  return transform;
}

Vec3d origin_of(const FloatGrid& grid) {
  return grid.transform().indexToWorld(openvdb::Coord(0));
}

}  // namespace

FloatGrid::Ptr along_axes(const FloatGrid::Ptr& grid) {
  const std::array<Vec3d, 3> steps = steps_of(*grid);
  if (!are_cubes(steps)) refuse(*grid, "does not have cubic voxels");
  const double side = steps[0].length();
  if (steps == std::array{Vec3d(side, 0, 0), Vec3d(0, side, 0), Vec3d(0, 0, side)}) return grid;
  return relocated(*grid, relocation_of(*grid, steps), lattice(side, origin_of(*grid)));
}

FloatGrid::Ptr on_lattice_of(const FloatGrid& first, const FloatGrid::Ptr& grid) {
  const double side = first.voxelSize()[0];
  const auto other = "other voxels than " + quoted(first.getName());
  if (std::abs(grid->voxelSize()[0] - side) > kRounding * side) {
    refuse(*grid, "has " + other + ": resample them onto one lattice");
  }
  const Vec3d apart = (origin_of(*grid) - origin_of(first)) / side;
  if (apart == Vec3d(0)) return grid;
  if (!(apart.length() < 1e7)) refuse(*grid, "lies too far from " + quoted(first.getName()));
  const openvdb::Coord shift = openvdb::Coord::round(apart);
  const Vec3d beside = apart - shift.asVec3d();
  if (!(beside.length() <= 1e-4)) {
    refuse(*grid,
           "has " + other + ", " + shown(beside) +
               " voxels beside them: resample them onto one lattice");
  }
  return relocated(*grid, {{0, 1, 2}, {1, 1, 1}, shift}, first.transform().copy());
}

}  // namespace wobblebench::phantoms
