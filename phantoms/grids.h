// The grids of a phantom, as OpenVDB level sets, and their size in memory. Light: what reads their
// voxels includes phantoms/float_grid.h too.
#pragma once

#include <openvdb/version.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "phantoms/phantom.h"

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

template <typename TreeT>
class Grid;

namespace tree {

template <typename RootT>
class Tree;
template <typename ChildT>
class RootNode;
template <typename ChildT, std::uint32_t Log2Dim>
class InternalNode;
template <typename T, std::uint32_t Log2Dim>
class LeafNode;

}  // namespace tree
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb

namespace wobblebench::phantoms {

/// openvdb::FloatGrid; defined in phantoms/float_grid.h.
using FloatGrid = openvdb::Grid<openvdb::tree::Tree<openvdb::tree::RootNode<
    openvdb::tree::InternalNode<openvdb::tree::InternalNode<openvdb::tree::LeafNode<float, 3>, 4>,
                                5>>>>;

/// Signed distances in metres (negative inside), world space = phantom frame in metres, in the
/// order of Phantom::surfaces(); narrow band, outside it signed background and flooded tiles.
struct Grids {
  std::vector<std::shared_ptr<const FloatGrid>> signed_distance;
};

/// The grids of a phantom with one surface.
inline std::shared_ptr<const Grids> single_grid(std::shared_ptr<const FloatGrid> grid) {
  auto grids = std::make_shared<Grids>();
  grids->signed_distance = {std::move(grid)};
  return grids;
}

struct GridMemory {
  double voxel_m = 0;
  std::uint64_t voxels = 0;  ///< active: within the narrow band
  std::uint64_t bytes = 0;   ///< in memory
};

/// Size of the grid of Phantom::surfaces()[surface].
GridMemory grid_memory(const Phantom& phantom, std::size_t surface);

struct BodySize {
  double volume_m3 = 0;  ///< within the surface, cavities left out
  double area_m2 = 0;
};

/// Of what Phantom::surfaces()[surface] encloses, integrated over its level set: within 1 % for
/// bodies that are 20 voxels thick, too small for those of few voxels. None where the grid cuts the
/// surface.
std::optional<BodySize> body_size(const Phantom& phantom, std::size_t surface);

}  // namespace wobblebench::phantoms
