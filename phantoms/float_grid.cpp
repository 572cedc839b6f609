#include "phantoms/float_grid.h"

#include <openvdb/math/Stencils.h>
#include <openvdb/tools/FastSweeping.h>

#include <cmath>
#include <numbers>

#include "phantoms/grids.h"
#include "phantoms/phantom.h"

namespace wobblebench::phantoms {

namespace {

/// Net normal over area, from which on a surface counts as cut.
constexpr double kOpenShare = 0.01;

}  // namespace

void initialize_openvdb() {
  openvdb::initialize();
}

FloatGrid::Ptr create_level_set(double voxel_m, double background_m) {
  auto grid = FloatGrid::create(static_cast<float>(background_m));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel_m));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

bool has_both_sides(const FloatGrid& grid) {
  bool inside = false, outside = false;
  for (auto value = grid.cbeginValueOn(); value && !(inside && outside); ++value) {
    inside |= *value < 0;
    outside |= *value > 0;
  }
  return inside && outside;
}

FloatGrid::Ptr widen_band(const FloatGrid& grid, int layers, Neighbours neighbours) {
  if (!has_both_sides(grid)) return grid.deepCopy();
  return openvdb::tools::dilateSdf(
      grid,
      layers,
      neighbours == Neighbours::faces ? openvdb::tools::NN_FACE : openvdb::tools::NN_FACE_EDGE);
}

GridMemory grid_memory(const Phantom& phantom, std::size_t surface) {
  const FloatGrid& grid = *phantom.grids().signed_distance.at(surface);
  return {grid.voxelSize()[0], grid.activeVoxelCount(), grid.memUsage()};
}

std::optional<BodySize> body_size(const Phantom& phantom, std::size_t surface) {
  const FloatGrid& grid = *phantom.grids().signed_distance.at(surface);
  if (!has_both_sides(grid) || !grid.hasUniformVoxels()) return std::nullopt;
  // Integrals over the surface, its delta function 3 voxels wide; by the divergence theorem the
  // flux of the position is three times the volume, and a closed surface has no net normal.
  constexpr double kHalfWidth = 1.5;
  const double voxel_m = grid.voxelSize()[0];
  openvdb::math::GradStencil<FloatGrid, false> stencil(grid);
  double area = 0, flux = 0;
  openvdb::Vec3d normal(0);
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    const double off = static_cast<double>(*value) / voxel_m;
    if (std::abs(off) >= kHalfWidth) continue;
    const double weight = (1 + std::cos(std::numbers::pi * off / kHalfWidth)) / (2 * kHalfWidth);
    stencil.moveTo(value);
    const openvdb::Vec3d gradient(stencil.gradient());
    area += weight * gradient.length();
    flux += weight * gradient.dot(value.getCoord().asVec3d());
    normal += weight * gradient;
  }
  if (normal.length() > kOpenShare * area) return std::nullopt;
  return BodySize{flux / 3 * voxel_m * voxel_m * voxel_m, area * voxel_m * voxel_m};
}

}  // namespace wobblebench::phantoms
