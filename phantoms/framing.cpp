#include "phantoms/framing.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

// z of the front of an imported body in the frame of the default probe: 65 mm below its face.
constexpr double kFront_m = (40 + 65) * 1e-3;

// Larger bodies extend beyond every field; smaller ones are not resolved.
constexpr double kLargestBody_m = 500e-3;
constexpr int kSmallestBody_voxels = 4;

constexpr Box kNowhere{glm::dvec3(std::numeric_limits<double>::infinity()),
                       glm::dvec3(-std::numeric_limits<double>::infinity())};

void include(Box& box, const glm::dvec3& point, double margin = 0) {
  box = {glm::min(box.low, point - margin), glm::max(box.high, point + margin)};
}

Box turned(const Box& box, const glm::dmat3& rotation) {
  Box bounds = kNowhere;
  for (const double x : {box.low.x, box.high.x}) {
    for (const double y : {box.low.y, box.high.y}) {
      for (const double z : {box.low.z, box.high.z})
        include(bounds, rotation * glm::dvec3(x, y, z));
    }
  }
  return bounds;
}

// Bounds of the turned surfaces. A voxel within one voxel of a surface says how far it lies; the
// outermost point of the surface lies that far from the voxel in the direction of the bound.
Box bounds_of_turned_surfaces(const Phantom& phantom, const glm::dmat3& rotation) {
  Box bounds = kNowhere;
  for (const auto& grid : phantom.grids().signed_distance) {
    const double voxel_m = grid->voxelSize()[0];
    for (auto value = grid->cbeginValueOn(); value; ++value) {
      const double distance_m = *value;
      if (distance_m >= 0 || distance_m < -voxel_m) continue;
      const auto world = grid->transform().indexToWorld(value.getCoord());
      include(bounds, rotation * to_glm(world), -distance_m);
    }
  }
  return bounds;
}

// Those that mesh_import.cpp and vdb_import.cpp make, also when read back from a file.
bool is_imported(const Phantom& phantom) {
  return phantom.name() == "mesh" || phantom.name() == "vdb";
}

std::string millimetres(const glm::dvec3& size_m) {
  std::ostringstream text;
  text << size_m.x * 1e3 << " x " << size_m.y * 1e3 << " x " << size_m.z * 1e3 << " mm";
  return text.str();
}

// Framing of an imported body whose surfaces lie within `bounds` (axes of the probe frame, relative
// to the origin).
Framing framing_of_body(const Box& bounds) {
  const glm::dvec3 middle = 0.5 * (bounds.low + bounds.high);
  const double half_x = std::clamp(bounds.high.x - middle.x + 5e-3, 15e-3, 60e-3);
  const double half_y = std::clamp(bounds.high.y - middle.y + 5e-3, 15e-3, 60e-3);
  const double front = bounds.low.z - 10e-3;
  return {{{middle.x - half_x, middle.y - half_y, front},
           {middle.x + half_x, middle.y + half_y, front + kBoxDepth_m}},
          {-middle.x, -middle.y, kFront_m - bounds.low.z}};
}

}  // namespace

Framing framing(const Phantom& phantom, const glm::dmat3& rotation) {
  if (rotation != glm::dmat3(1.0) && is_imported(phantom)) {
    const Box bounds = bounds_of_turned_surfaces(phantom, rotation);
    if (bounds.low.x <= bounds.high.x) return framing_of_body(bounds);
  }
  return {turned(phantom.region_of_interest(), rotation), phantom.suggested_position_m()};
}

void check_size(const Box& bounds, double voxel_m) {
  const glm::dvec3 size = bounds.high - bounds.low;
  const double least = std::min({size.x, size.y, size.z});
  std::ostringstream reason;
  if (!(std::max({size.x, size.y, size.z}) <= kLargestBody_m)) {
    reason << "measures " << millimetres(size) << ", more than " << kLargestBody_m * 1e3
           << ": is unit_mm right?";
  } else if (!(least >= kSmallestBody_voxels * voxel_m)) {
    reason << "measures " << millimetres(size) << ", less than " << kSmallestBody_voxels
           << " voxels of " << voxel_m * 1e3 << " mm: is unit_mm right?";
  } else {
    return;
  }
  throw std::invalid_argument(reason.str());
}

Phantom imported_phantom(const PhantomOptions& options,
                         std::vector<Surface> surfaces,
                         const Box& bounds,
                         std::shared_ptr<const Grids> grids) {
  const Framing framing = framing_of_body(bounds);
  return Phantom(options.name,
                 material_table(),
                 material_index(options.background),
                 std::move(surfaces),
                 framing.region_of_interest,
                 framing.position_m,
                 std::move(grids));
}

}  // namespace wobblebench::phantoms
