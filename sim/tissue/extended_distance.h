// Signed distances of a surface beyond the narrow band of its level set, at the nodes of a regular
// grid. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/Grid.h>

#include <optional>

#include "phantoms/grids.h"

namespace wobblebench::sim {

/// A level set, sampled by one thread at nodes: the integer multiples of a step. Nodes that are
/// voxel centres need no interpolation.
class GridReader {
 public:
  GridReader(const phantoms::FloatGrid& grid, double step_m);

  float at_node(const openvdb::Coord& node);
  /// Trilinear.
  float at(const openvdb::Vec3d& position_m);

 private:
  phantoms::FloatGrid::ConstAccessor accessor_;
  const phantoms::FloatGrid* grid_;
  double step_m_;
  int voxels_per_step_;  ///< 0: nodes are not voxel centres
  openvdb::Coord origin_;
};

/// The distances of one surface: the phantom's own narrow band, and beyond it a coarser level set
/// with distances up to the reach (first order, by fast sweeping). The nodes of the coarser one are
/// every second node.
class ExtendedDistance {
 public:
  ExtendedDistance() = default;
  ExtendedDistance(phantoms::FloatGrid::ConstPtr fine, double step_m, double reach_m);

  /// Access for one thread.
  class Reader {
   public:
    explicit Reader(const ExtendedDistance& source);
    /// Signed distance within the reach; beyond it only its sign is valid.
    float at(const openvdb::Coord& node);

   private:
    float trusted_m_;
    double step_m_;
    GridReader fine_;
    std::optional<GridReader> coarse_;
  };

 private:
  void extend(double reach_m);

  phantoms::FloatGrid::ConstPtr fine_;
  double step_m_ = 0;
  double band_m_ = 0;
  phantoms::FloatGrid::Ptr coarse_;
};

}  // namespace wobblebench::sim
