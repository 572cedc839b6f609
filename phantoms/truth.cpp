#include "phantoms/truth.h"

#include <openvdb/math/Ray.h>
#include <openvdb/math/Stencils.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/RayIntersector.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/io/clearance.h"

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

// The part of the grid within the box and a margin around it; signs within it are kept.
Grid::ConstPtr clipped(const Grid::ConstPtr& grid, const Box& box, double margin_m) {
  Grid::Ptr clip = deep_copy(*grid);
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
