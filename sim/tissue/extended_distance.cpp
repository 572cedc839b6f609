#include "sim/tissue/extended_distance.h"

#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <cmath>
#include <utility>

#include "phantoms/float_grid.h"

namespace wobblebench::sim {

namespace {

using Grid = phantoms::FloatGrid;

/// Fraction of the narrow band within which interpolation does not reach the constant background.
constexpr double kTrusted = 0.75;

/// Voxels per step if all nodes are voxel centres of the grid; else 0.
int voxels_per_step(const Grid& grid, double step_m) {
  const openvdb::Vec3d origin = grid.worldToIndex(openvdb::Vec3d(0));
  const openvdb::Vec3d diagonal = grid.worldToIndex(openvdb::Vec3d(step_m)) - origin;
  const openvdb::Vec3d along_x = grid.worldToIndex(openvdb::Vec3d(step_m, 0, 0)) - origin;
  const double ratio = std::round(diagonal.x());
  const openvdb::Vec3d whole(
      std::round(origin.x()), std::round(origin.y()), std::round(origin.z()));
  constexpr double kRounding = 1e-6;
  const bool fits = ratio >= 1 && (origin - whole).length() < kRounding &&
                    (diagonal - openvdb::Vec3d(ratio)).length() < kRounding &&
                    (along_x - openvdb::Vec3d(ratio, 0, 0)).length() < kRounding;
  return fits ? static_cast<int>(ratio) : 0;
}

openvdb::Coord scaled(const openvdb::Coord& c, int factor) {
  return {c.x() * factor, c.y() * factor, c.z() * factor};
}

openvdb::Vec3d gradient_at(Grid::ConstAccessor& tree, const openvdb::Coord& at, double voxel_m) {
  openvdb::Vec3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Coord low = at, high = at;
    low[axis] -= 1;
    high[axis] += 1;
    gradient[axis] = static_cast<double>(tree.getValue(high) - tree.getValue(low)) / (2 * voxel_m);
  }
  return gradient;
}

/// Where the narrow band ends within a step of the coarse grid, distances of the nodes around each
/// voxel at the surface: those of the tangent plane there, of the nearest such voxel.
void add_tangent_distances(const Grid& fine, double coarse_m, Grid& coarse) {
  const Grid::Ptr nearest = phantoms::create_level_set(coarse_m, 1);  // squared distances, m^2
  auto target = coarse.getAccessor(), known = nearest->getAccessor();
  for (auto voxel = coarse.cbeginValueOn(); voxel; ++voxel) known.setValueOn(voxel.getCoord(), 0);
  auto source = fine.getConstAccessor();
  const double voxel_m = fine.voxelSize()[0];
  for (auto voxel = fine.cbeginValueOn(); voxel; ++voxel) {
    if (!voxel.isVoxelValue() || std::abs(static_cast<double>(*voxel)) > voxel_m) continue;
    const openvdb::Vec3d at = fine.indexToWorld(voxel.getCoord());
    const openvdb::Vec3d gradient = gradient_at(source, voxel.getCoord(), voxel_m);
    const openvdb::Coord low = openvdb::Coord::floor(at / coarse_m);
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Coord node = low.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2);
      const openvdb::Vec3d offset = node.asVec3d() * coarse_m - at;
      const auto distance2 = static_cast<float>(offset.lengthSqr());
      if (distance2 >= known.getValue(node)) continue;
      known.setValueOn(node, distance2);
      target.setValueOn(node,
                        static_cast<float>(static_cast<double>(*voxel) + gradient.dot(offset)));
    }
  }
}

bool is_multiple(const openvdb::Coord& c, int factor) {
  return c.x() % factor == 0 && c.y() % factor == 0 && c.z() % factor == 0;
}

}  // namespace

GridReader::GridReader(const Grid& grid, double step_m)
    : accessor_(grid.getConstAccessor()),
      grid_(&grid),
      step_m_(step_m),
      voxels_per_step_(voxels_per_step(grid, step_m)),
      origin_(openvdb::Coord::round(grid.worldToIndex(openvdb::Vec3d(0)))) {}

float GridReader::at_node(const openvdb::Coord& node) {
  if (voxels_per_step_ == 0) return at(node.asVec3d() * step_m_);
  return accessor_.getValue(scaled(node, voxels_per_step_) + origin_);
}

float GridReader::at(const openvdb::Vec3d& position_m) {
  return openvdb::tools::BoxSampler::sample(accessor_, grid_->worldToIndex(position_m));
}

ExtendedDistance::ExtendedDistance(Grid::ConstPtr fine, double step_m, double reach_m)
    : fine_(std::move(fine)), step_m_(step_m), band_m_(static_cast<double>(fine_->background())) {
  if (!fine_->empty() && band_m_ < reach_m) extend(reach_m);
}

void ExtendedDistance::extend(double reach_m) {
  const double coarse_m = 2 * step_m_, voxel_m = fine_->voxelSize()[0];
  const bool thin = kTrusted * band_m_ < coarse_m;
  const Grid::Ptr coarse = phantoms::create_level_set(coarse_m, thin ? 2 * coarse_m : band_m_);
  GridReader source(*fine_, coarse_m);
  auto target = coarse->getAccessor();
  const int voxels = voxels_per_step(*fine_, coarse_m);
  const openvdb::Coord origin = openvdb::Coord::round(fine_->worldToIndex(openvdb::Vec3d(0)));
  for (auto voxel = fine_->cbeginValueOn(); voxel; ++voxel) {
    // Where nodes are voxel centres, only those voxels count: a node off the band is not trusted.
    if (voxels > 0 && !is_multiple(voxel.getCoord() - origin, voxels)) continue;
    const openvdb::Vec3d at = fine_->indexToWorld(voxel.getCoord());
    const openvdb::Coord node = openvdb::Coord::round(at / coarse_m);
    // A node is computed once, for the first voxel next to it.
    if ((at - node.asVec3d() * coarse_m).length() > voxel_m || target.isValueOn(node)) continue;
    const float value = source.at_node(node);
    if (std::abs(static_cast<double>(value)) < kTrusted * band_m_) target.setValueOn(node, value);
  }
  if (thin) add_tangent_distances(*fine_, coarse_m, *coarse);
  openvdb::tools::signedFloodFill(coarse->tree());
  if (!phantoms::has_both_sides(*coarse)) {  // a body between the nodes
    const int fine_layers = static_cast<int>(std::ceil((reach_m - band_m_) / voxel_m)) + 1;
    coarse_ = phantoms::widen_band(*fine_, fine_layers, phantoms::Neighbours::faces);
    return;
  }
  const int layers = static_cast<int>(std::ceil((reach_m - kTrusted * band_m_) / coarse_m)) + 1;
  // Of a thin band nothing is left to lose along diagonals.
  coarse_ = phantoms::widen_band(
      *coarse, layers, thin ? phantoms::Neighbours::faces_and_edges : phantoms::Neighbours::faces);
}

ExtendedDistance::Reader::Reader(const ExtendedDistance& source)
    : trusted_m_(static_cast<float>(kTrusted * source.band_m_)),
      step_m_(source.step_m_),
      fine_(*source.fine_, source.step_m_) {
  if (source.coarse_) coarse_.emplace(*source.coarse_, 2 * source.step_m_);
}

float ExtendedDistance::Reader::at(const openvdb::Coord& node) {
  const float near = fine_.at_node(node);
  if (!coarse_ || std::abs(near) < trusted_m_) return near;
  const bool shared = ((node.x() | node.y() | node.z()) & 1) == 0;
  if (!shared) return coarse_->at(node.asVec3d() * step_m_);
  return coarse_->at_node({node.x() / 2, node.y() / 2, node.z() / 2});
}

}  // namespace wobblebench::sim
