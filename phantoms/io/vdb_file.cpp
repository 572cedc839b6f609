#include "phantoms/io/vdb_file.h"

#include <openvdb/math/Maps.h>
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <set>
#include <stdexcept>
#include <system_error>

#include "phantoms/float_grid.h"
#include "phantoms/io/import_process.h"
#include "phantoms/io/message.h"

namespace wobblebench::phantoms {
namespace {

using Leaf = FloatGrid::TreeType::LeafNodeType;
using Branch = FloatGrid::TreeType::RootNodeType::ChildNodeType;
using Twig = Branch::ChildNodeType;

/// Farther voxels would overflow the arithmetic of their neighbours.
constexpr std::int32_t kFarthestIndex = 1 << 28;

[[noreturn]] void damaged() {
  throw std::invalid_argument("is damaged: what was read of it makes no grid");
}

openvdb::Coord corner(const std::array<std::int32_t, 3>& low) {
  for (const std::int32_t axis : low) {
    if (axis <= -kFarthestIndex || axis >= kFarthestIndex) {
      throw std::invalid_argument("holds voxels too far from its origin");
    }
  }
  return {low[0], low[1], low[2]};
}

/// A tree grown from tiles and leaves. A single tile may make whole branches: they are counted.
class TreeBuilder {
 public:
  explicit TreeBuilder(FloatGrid& grid) : tree_(grid.tree()) {}

  void add(const VdbTile& tile) {
    const openvdb::Coord low = corner(tile.low);
    if (tile.level < 1 || tile.level > 3) damaged();
    if (tile.level < 3) count_branch(low);
    if (tile.level < 2) count_twig(low);
    tree_.addTile(static_cast<openvdb::Index>(tile.level), low, tile.value, tile.active != 0);
  }
  void add(const VdbLeaf& record) {
    const openvdb::Coord low = corner(record.low);
    count_branch(low);
    count_twig(low);
    count(sizeof(Leaf) + sizeof record.values);
    auto leaf = std::make_unique<Leaf>(low, tree_.background());
    for (openvdb::Index i = 0; i < VdbLeaf::kVoxels; ++i) {
      const bool active = (record.active[i / 64] >> (i % 64) & 1) != 0;
      active ? leaf->setValueOn(i, record.values[i]) : leaf->setValueOff(i, record.values[i]);
    }
    tree_.addLeaf(leaf.release());
  }

 private:
  template <class Node>
  static openvdb::Coord node_of(const openvdb::Coord& low) {
    constexpr openvdb::Int32 kMask = ~static_cast<openvdb::Int32>(Node::DIM - 1);
    return {low.x() & kMask, low.y() & kMask, low.z() & kMask};
  }
  void count_branch(const openvdb::Coord& low) {
    if (branches_.insert(node_of<Branch>(low)).second) count(sizeof(Branch));
  }
  void count_twig(const openvdb::Coord& low) {
    if (twigs_.insert(node_of<Twig>(low)).second) count(sizeof(Twig));
  }
  void count(std::size_t bytes) { check_bytes(bytes_ += double(bytes), ": use larger voxels"); }

  FloatGrid::TreeType& tree_;
  std::set<openvdb::Coord> branches_, twigs_;
  double bytes_ = 0;
};

openvdb::math::Transform::Ptr read_transform(MessageReader& in) {
  openvdb::Mat4d matrix;
  for (int i = 0; i < 16; ++i) {
    matrix.asPointer()[i] = in.get<double>();
    if (!std::isfinite(matrix.asPointer()[i])) damaged();
  }
  const auto affine = std::make_shared<openvdb::math::AffineMap>(matrix);
  return std::make_shared<openvdb::math::Transform>(openvdb::math::simplify(affine));
}

FloatGrid::Ptr read_distances(MessageReader& in, const std::string& grid_class) {
  const auto transform = read_transform(in);
  FloatGrid::Ptr grid = create_level_set(1, double(in.get<float>()));
  grid->setTransform(transform);
  grid->setGridClass(openvdb::GridBase::stringToGridClass(grid_class));
  TreeBuilder tree(*grid);
  for (auto tile = in.get<VdbTile>(); tile.level != kNoMoreTiles; tile = in.get<VdbTile>()) {
    tree.add(tile);
  }
  for (auto left = in.get<std::uint64_t>(); left > 0; --left) tree.add(in.get<VdbLeaf>());
  return grid;
}

std::unique_ptr<openvdb::Metadata> read_value(MessageReader& in, VdbMetadata type) {
  switch (type) {
    case VdbMetadata::text:
      return std::make_unique<openvdb::StringMetadata>(in.text());
    case VdbMetadata::number:
      return std::make_unique<openvdb::DoubleMetadata>(in.get<double>());
    case VdbMetadata::integer:
      return std::make_unique<openvdb::Int32Metadata>(in.get<std::int32_t>());
    case VdbMetadata::flag:
      return std::make_unique<openvdb::BoolMetadata>(in.get<std::int32_t>() != 0);
    case VdbMetadata::vector: {
      openvdb::Vec3d value;
      for (int axis = 0; axis < 3; ++axis) value[axis] = in.get<double>();
      return std::make_unique<openvdb::Vec3DMetadata>(value);
    }
    case VdbMetadata::end:
      break;
  }
  damaged();
}

VdbFile parsed(std::string_view message) {
  MessageReader in(message);
  VdbFile file;
  for (auto type = in.get<VdbMetadata>(); type != VdbMetadata::end; type = in.get<VdbMetadata>()) {
    const std::string key = in.text();
    if (key.empty()) damaged();
    file.metadata.insertMeta(key, *read_value(in, type));
  }
  for (auto contents = in.get<VdbContents>(); contents != VdbContents::end;
       contents = in.get<VdbContents>()) {
    VdbGrid grid{in.text(), in.text(), in.text(), nullptr};
    if (contents == VdbContents::distances) {
      grid.distances = read_distances(in, grid.grid_class);
      grid.distances->setName(grid.name);
    } else if (contents != VdbContents::name_alone) {
      damaged();
    }
    file.grids.push_back(std::move(grid));
  }
  if (!in.at_end()) damaged();
  return file;
}

}  // namespace

VdbFile read_vdb(const std::filesystem::path& path) {
  initialize_openvdb();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) throw std::invalid_argument("no such file");
  return vdb_from_message(ImportedBytes(ImportFormat::vdb, path).message());
}

VdbFile vdb_from_message(std::string_view message) {
  try {
    return parsed(message);
  } catch (const openvdb::Exception& error) {
    throw std::invalid_argument(std::string("not a readable OpenVDB file (") + error.what() + ")");
  }
}

void check_level_set(const std::string& name, const FloatGrid& grid) {
  if (grid.getGridClass() != openvdb::GRID_LEVEL_SET) {
    throw std::invalid_argument("grid \"" + name + "\" is not of the class level set");
  }
  if (!grid.transform().isLinear() || !grid.hasUniformVoxels()) {
    throw std::invalid_argument("grid \"" + name + "\" does not have cubic voxels");
  }
  if (!(grid.background() > 0)) {
    throw std::invalid_argument("grid \"" + name + "\" has no positive background");
  }
  for (auto value = grid.cbeginValueAll(); value; ++value) {
    if (!std::isfinite(*value)) {
      throw std::invalid_argument("grid \"" + name + "\" holds a value that is not finite");
    }
  }
}

}  // namespace wobblebench::phantoms
