// Signed distances farther from a surface than its level set's narrow band knows them, at the
// points of a lattice. Heavy: include it from .cpp files only.
#pragma once

#include <openvdb/openvdb.h>

#include <optional>

namespace wobblebench::sim {

/// A level set at any place, read by one thread. Lattice points that are voxels need no
/// interpolation.
class GridReader {
 public:
  GridReader(const openvdb::FloatGrid& grid, double lattice_step_m);

  /// At a point of the lattice.
  float at_node(const openvdb::Coord& node);
  float at(const openvdb::Vec3d& place_m);

 private:
  openvdb::FloatGrid::ConstAccessor accessor_;
  const openvdb::FloatGrid* grid_;
  double step_m_;
  int voxels_per_step_;  ///< 0: lattice points lie between voxels
  openvdb::Coord origin_;
};

/// One surface, near and a little farther: the phantom's own narrow band, and a coarser level set
/// that knows distances up to the reach (first order, by fast sweeping). The coarser one has every
/// second point of the lattice.
class ExtendedDistance {
 public:
  ExtendedDistance() = default;
  ExtendedDistance(openvdb::FloatGrid::ConstPtr fine, double step_m, double reach_m);

  /// Access for one thread.
  class Reader {
   public:
    explicit Reader(const ExtendedDistance& source);
    /// Signed distance, exact within the reach; beyond it only its sign counts.
    float at(const openvdb::Coord& node);

   private:
    float trusted_m_;
    double step_m_;
    GridReader fine_;
    std::optional<GridReader> wide_;
  };

 private:
  void widen(double reach_m);

  openvdb::FloatGrid::ConstPtr fine_;
  double step_m_ = 0;
  double band_m_ = 0;
  openvdb::FloatGrid::Ptr wide_;
};

}  // namespace wobblebench::sim
