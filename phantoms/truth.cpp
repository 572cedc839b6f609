#include "phantoms/truth.h"

#include <openvdb/math/Ray.h>
#include <openvdb/math/Stencils.h>
#include <openvdb/tools/FastSweeping.h>
#include <openvdb/tools/RayIntersector.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "phantoms/grids.h"
#include "phantoms/io/clearance.h"

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

/// What of the grid lies in the box and a margin around it. Signs within stay what they are.
Grid::ConstPtr clipped(const Grid::ConstPtr& grid, const Box& box, double margin_m) {
  Grid::Ptr clip = grid->deepCopy();
  clip->clipGrid({to_vdb(box.low - margin_m), to_vdb(box.high + margin_m)});
  return clip;
}

/// The grid with a band that holds every point in the box that lies within `reach_m` of the
/// surface.
Grid::ConstPtr with_reach(Grid::ConstPtr grid, double reach_m, const std::optional<Box>& within) {
  const double voxel_m = grid->voxelSize()[0];
  const double missing_m = reach_m - static_cast<double>(grid->background());
  if (missing_m <= 0) return grid;
  if (within) grid = clipped(grid, *within, reach_m + 2 * voxel_m);
  if (grid->empty()) return grid;
  // Over faces alone a band grows by less than a voxel a step along diagonals.
  return openvdb::tools::dilateSdf(
      *grid, static_cast<int>(std::ceil(missing_m / voxel_m)), openvdb::tools::NN_FACE_EDGE);
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

    // Trilinear distance; nothing beyond the narrow band.
    std::optional<Distance> distance(const glm::dvec3& position) {
      const openvdb::Vec3d index = grid->worldToIndex(to_vdb(position));
      if (!values.isValueOn(openvdb::Coord::round(index))) return std::nullopt;
      stencil.moveTo(index);
      return Distance{stencil.interpolation(index), to_glm(stencil.gradient(index))};
    }

    double cautious_distance(const glm::dvec3& position) {
      const openvdb::Vec3d index = grid->worldToIndex(to_vdb(position));
      float value = 0;
      if (values.probeValue(openvdb::Coord::round(index), value)) {
        stencil.moveTo(index);
        return stencil.interpolation(index);
      }
      // The nearest voxel, less than one away, is beyond the band.
      const double beyond_m =
          static_cast<double>(grid->background()) +
          grid->voxelSize()[0] * (clearance->voxels(openvdb::Coord::round(index)) - 1);
      return std::copysign(beyond_m, static_cast<double>(value));
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

double SurfaceFinder::cautious_distance(int target, const glm::dvec3& position) const {
  return state_->targets.at(static_cast<std::size_t>(target)).cautious_distance(position);
}

}  // namespace wobblebench::phantoms
