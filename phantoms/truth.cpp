#include "phantoms/truth.h"

#include <openvdb/math/Ray.h>
#include <openvdb/math/Stencils.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/RayIntersector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

using Grid = FloatGrid;
// Two refinements: the linear search alone is off by some hundredths of a voxel on curved surfaces.
using Search = openvdb::tools::LinearSearchImpl<Grid, 2, double>;
using Intersector =
    openvdb::tools::LevelSetRayIntersector<Grid,
                                           Search,
                                           Grid::TreeType::RootNodeType::ChildNodeType::LEVEL,
                                           openvdb::math::Ray<double>>;
using Stencil = openvdb::math::BoxStencil<const Grid>;

int floor_divided(int a, int b) {
  return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/// Distance from a voxel to the narrow band of a level set, as a lower bound: a Chebyshev distance
/// transform over blocks of voxels, at most 128 blocks a side, however large the grid.
class Clearance {
 public:
  explicit Clearance(const Grid& grid) {
    const openvdb::CoordBBox band = grid.evalActiveVoxelBoundingBox();
    if (band.empty()) return;
    // A block is a whole number of leaves across, so that each leaf lies in one block.
    const int leaves = band.dim()[band.maxExtent()] / 8 + 2;
    block_voxels_ = 8 * ((leaves + kMostBlocks - 1) / kMostBlocks);
    blocks_ = {block_of(band.min()), block_of(band.max())};
    steps_.assign(blocks_.volume(), kFar);
    std::vector<openvdb::Coord> occupied;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
      if (leaf->isEmpty()) continue;
      const openvdb::Coord block = block_of(leaf->origin());
      if (steps_[index_of(block)] == 0) continue;
      steps_[index_of(block)] = 0;
      occupied.push_back(block);
    }
    propagate(std::move(occupied));
  }

  /// A distance, in voxels, within which no voxel of the band lies; 0 near the band.
  double voxels(const openvdb::Coord& voxel) const {
    if (steps_.empty()) return std::numeric_limits<double>::infinity();
    const openvdb::Coord block = block_of(voxel);
    if (blocks_.isInside(block)) {
      return block_voxels_ * std::max(0.0, steps_[index_of(block)] - 1.0);
    }
    int beyond = 0;
    for (int axis = 0; axis < 3; ++axis) {
      beyond = std::max(
          {beyond, blocks_.min()[axis] - block[axis] - 1, block[axis] - blocks_.max()[axis] - 1});
    }
    return 1.0 * block_voxels_ * beyond;
  }

 private:
  openvdb::Coord block_of(const openvdb::Coord& voxel) const {
    return {floor_divided(voxel.x(), block_voxels_),
            floor_divided(voxel.y(), block_voxels_),
            floor_divided(voxel.z(), block_voxels_)};
  }
  std::size_t index_of(const openvdb::Coord& block) const {
    const openvdb::Coord at = block - blocks_.min(), size = blocks_.dim();
    return (static_cast<std::size_t>(at.x()) * static_cast<std::size_t>(size.y()) +
            static_cast<std::size_t>(at.y())) *
               static_cast<std::size_t>(size.z()) +
           static_cast<std::size_t>(at.z());
  }
  // Breadth first, one shell of blocks at a time, over faces, edges and corners.
  void propagate(std::vector<openvdb::Coord> shell) {
    for (std::uint8_t step = 1; !shell.empty() && step < kFar; ++step) {
      std::vector<openvdb::Coord> next;
      for (const openvdb::Coord& block : shell) {
        openvdb::CoordBBox around(block.offsetBy(-1), block.offsetBy(1));
        around.intersect(blocks_);
        for (const openvdb::Coord& neighbour : around) {
          std::uint8_t& known = steps_[index_of(neighbour)];
          if (known <= step) continue;
          known = step;
          next.push_back(neighbour);
        }
      }
      shell = std::move(next);
    }
  }

  static constexpr int kMostBlocks = 128;
  static constexpr std::uint8_t kFar = std::numeric_limits<std::uint8_t>::max();

  int block_voxels_ = 8;
  openvdb::CoordBBox blocks_;
  std::vector<std::uint8_t> steps_;  ///< [block]: blocks to the nearest one that holds the band
};

// The part of the grid within the box and a margin around it; signs within it are kept.
Grid::ConstPtr clipped(const Grid::ConstPtr& grid, const Box& box, double margin_m) {
  Grid::Ptr clip = grid->deepCopy();
  clip->clipGrid({to_vdb(box.low - margin_m), to_vdb(box.high + margin_m)});
  return clip;
}

// The grid with a band that contains every point of the box within `reach_m` of the surface.
Grid::ConstPtr with_reach(Grid::ConstPtr grid, double reach_m, const std::optional<Box>& within) {
  const double voxel_m = grid->voxelSize()[0];
  const double missing_m = reach_m - static_cast<double>(grid->background());
  if (missing_m <= 0) return grid;
  if (within) grid = clipped(grid, *within, reach_m + 2 * voxel_m);
  if (grid->empty()) return grid;
  return widen_band(
      *grid, static_cast<int>(std::ceil(missing_m / voxel_m)), Neighbours::faces_and_edges);
}

}  // namespace

struct SurfaceFinder::State {
  struct Target {
    Target(int index, Grid::ConstPtr g, std::shared_ptr<const Clearance> c)
        : surface(index),
          grid(std::move(g)),
          intersector(*grid),
          stencil(*grid),
          values(grid->getConstAccessor()),
          clearance(std::move(c)) {}
    Target(const Target& other) : Target(other.surface, other.grid, other.clearance) {}

    // Trilinear; nullopt outside the narrow band.
    std::optional<Distance> distance(const glm::dvec3& position) {
      const openvdb::Vec3d index = grid->worldToIndex(to_vdb(position));
      if (!values.isValueOn(openvdb::Coord::round(index))) return std::nullopt;
      stencil.moveTo(index);
      return Distance{stencil.interpolation(index), to_glm(stencil.gradient(index))};
    }

    double distance_bound(const glm::dvec3& position) {
      const openvdb::Vec3d index = grid->worldToIndex(to_vdb(position));
      float value = 0;
      if (values.probeValue(openvdb::Coord::round(index), value)) {
        stencil.moveTo(index);
        return stencil.interpolation(index);
      }
      // Minus 1: the nearest voxel, less than one away, lies outside the band.
      const double bound_m =
          static_cast<double>(grid->background()) +
          grid->voxelSize()[0] * (clearance->voxels(openvdb::Coord::round(index)) - 1);
      return std::copysign(bound_m, static_cast<double>(value));
    }

    int surface;
    Grid::ConstPtr grid;
    Intersector intersector;
    Stencil stencil;
    Grid::ConstAccessor values;
    std::shared_ptr<const Clearance> clearance;
  };

  std::vector<Target> targets;
};

SurfaceFinder::SurfaceFinder(const Phantom& phantom,
                             double reach_m,
                             const std::optional<Box>& within)
    : state_(std::make_unique<State>()) {
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    if (!phantom.surfaces()[i].is_target) continue;
    const auto grid = with_reach(phantom.grids().signed_distance[i], reach_m, within);
    if (grid->empty()) continue;
    state_->targets.emplace_back(int(i), grid, std::make_shared<Clearance>(*grid));
  }
}

SurfaceFinder::SurfaceFinder(const SurfaceFinder& other)
    : state_(std::make_unique<State>(*other.state_)) {}

SurfaceFinder::~SurfaceFinder() = default;

std::optional<SurfaceHit> SurfaceFinder::first_hit(const glm::dvec3& origin,
                                                   const glm::dvec3& direction,
                                                   double from_m,
                                                   double to_m) const {
  std::optional<SurfaceHit> nearest;
  for (State::Target& target : state_->targets) {
    const double limit_m = nearest ? nearest->distance_m : to_m;
    if (!(from_m < limit_m)) continue;
    // The search steps from voxel to voxel: it needs a margin to detect a crossing just before the
    // limit.
    const double end_m = limit_m + 2 * target.grid->voxelSize()[0];
    // OpenVDB's rays begin beyond 0.
    const double begin_m = std::max(from_m, openvdb::math::Delta<double>::value());
    const openvdb::math::Ray<double> ray(to_vdb(origin), to_vdb(direction), begin_m, end_m);
    openvdb::Vec3d crossing;
    if (!target.intersector.intersectsWS(ray, crossing)) continue;
    const double distance_m = glm::dot(to_glm(crossing) - origin, direction);
    if (distance_m > limit_m) continue;
    const auto field = target.distance(to_glm(crossing));
    const glm::dvec3 normal = field ? glm::normalize(field->gradient) : -direction;
    nearest = SurfaceHit{distance_m, normal, target.surface};
  }
  return nearest;
}

std::optional<SurfaceFinder::Distance> SurfaceFinder::distance(const glm::dvec3& position) const {
  std::optional<Distance> nearest;
  for (State::Target& target : state_->targets) {
    const auto candidate = target.distance(position);
    if (!candidate) continue;
    if (!nearest || std::abs(candidate->value_m) < std::abs(nearest->value_m)) nearest = candidate;
  }
  return nearest;
}

int SurfaceFinder::targets() const {
  return static_cast<int>(state_->targets.size());
}

int SurfaceFinder::surface(int target) const {
  return state_->targets.at(static_cast<std::size_t>(target)).surface;
}

std::optional<SurfaceFinder::Distance> SurfaceFinder::target_distance(
    int target, const glm::dvec3& position) const {
  return state_->targets.at(static_cast<std::size_t>(target)).distance(position);
}

double SurfaceFinder::distance_bound(int target, const glm::dvec3& position) const {
  return state_->targets.at(static_cast<std::size_t>(target)).distance_bound(position);
}

}  // namespace wobblebench::phantoms
