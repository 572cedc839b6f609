#include "phantoms/truth.h"

#include <openvdb/math/Ray.h>
#include <openvdb/math/Stencils.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/RayIntersector.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/grids.h"

namespace wobblebench::phantoms {
namespace {

using Grid = openvdb::FloatGrid;
// Two refinements: the linear search alone errs by some hundredths of a voxel on curved surfaces.
using Search = openvdb::tools::LinearSearchImpl<Grid, 2, double>;
using Intersector =
    openvdb::tools::LevelSetRayIntersector<Grid,
                                           Search,
                                           Grid::TreeType::RootNodeType::ChildNodeType::LEVEL,
                                           openvdb::math::Ray<double>>;
using Stencil = openvdb::math::BoxStencil<const Grid>;

openvdb::Vec3d to_vdb(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}
glm::dvec3 to_glm(const openvdb::Vec3d& v) {
  return {v.x(), v.y(), v.z()};
}

/// The grid with a band that holds every point within `reach_m` of the surface.
Grid::ConstPtr with_reach(const Grid::ConstPtr& grid, double reach_m) {
  const double missing_m = reach_m - static_cast<double>(grid->background());
  if (missing_m <= 0) return grid;
  return openvdb::tools::dilateSdf(*grid,
                                   static_cast<int>(std::ceil(missing_m / grid->voxelSize()[0])));
}

}  // namespace

struct SurfaceFinder::State {
  struct Target {
    Target(int index, Grid::ConstPtr g)
        : surface(index), grid(std::move(g)), intersector(*grid), stencil(*grid) {}
    Target(const Target& other) : Target(other.surface, other.grid) {}

    // Trilinear distance; nothing beyond the narrow band.
    std::optional<Distance> distance(const glm::dvec3& position) {
      const openvdb::Vec3d index = grid->worldToIndex(to_vdb(position));
      if (!grid->tree().isValueOn(openvdb::Coord::round(index))) return std::nullopt;
      stencil.moveTo(index);
      return Distance{stencil.interpolation(index), to_glm(stencil.gradient(index))};
    }

    int surface;
    Grid::ConstPtr grid;
    Intersector intersector;
    Stencil stencil;
  };

  std::vector<Target> targets;
};

SurfaceFinder::SurfaceFinder(const Phantom& phantom, double reach_m)
    : state_(std::make_unique<State>()) {
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const auto& grid = phantom.grids().signed_distance[i];
    if (phantom.surfaces()[i].is_target && !grid->empty()) {
      state_->targets.emplace_back(int(i), with_reach(grid, reach_m));
    }
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
    // The search looks from voxel to voxel: it needs room to see a crossing just before the limit.
    const double end_m = limit_m + 2 * target.grid->voxelSize()[0];
    // OpenVDB's rays begin beyond 0.
    const double begin_m = std::max(from_m, openvdb::math::Delta<double>::value());
    const openvdb::math::Ray<double> ray(to_vdb(origin), to_vdb(direction), begin_m, end_m);
    openvdb::Vec3d place;
    if (!target.intersector.intersectsWS(ray, place)) continue;
    const double distance_m = glm::dot(to_glm(place) - origin, direction);
    if (distance_m > limit_m) continue;
    const auto there = target.distance(to_glm(place));
    const glm::dvec3 normal = there ? glm::normalize(there->gradient) : -direction;
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

}  // namespace wobblebench::phantoms
