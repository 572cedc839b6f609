// Forward declaration of OpenVDB's grid of floats, for headers.
#pragma once

#include <openvdb/version.h>

#include <cstdint>

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

}  // namespace wobblebench::phantoms
