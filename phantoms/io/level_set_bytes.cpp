#include "phantoms/io/level_set_bytes.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "phantoms/float_grid.h"

namespace wobblebench::phantoms {
namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
using openvdb::math::UniformScaleMap;
using openvdb::math::UniformScaleTranslateMap;

constexpr int kWords = Leaf::SIZE / 64;
constexpr std::int32_t kFarthestVoxel = 1 << 20;  // voxels from the origin: 100 m and more

/// A leaf of the tree but its active values.
struct LeafHead {
  std::array<std::int32_t, 3> origin{};
  std::uint32_t unused = 0;
  std::array<std::uint64_t, kWords> active{};
  std::array<std::uint64_t, kWords>
      negative{};  ///< inactive voxels whose value is minus the background
};
struct Tile {
  std::array<std::int32_t, 3> origin{};
  std::uint16_t level = 1;
  std::uint16_t negative = 0;
};

std::array<std::int32_t, 3> array_of(const openvdb::Coord& at) {
  return {at.x(), at.y(), at.z()};
}

openvdb::Coord coord_of(const std::array<std::int32_t, 3>& at) {
  for (const std::int32_t along : at) {
    expect_bytes(along >= -kFarthestVoxel && along <= kFarthestVoxel, "a voxel is too far away");
  }
  return {at[0], at[1], at[2]};
}

bool in_set(const std::array<std::uint64_t, kWords>& set, int voxel) {
  return (set[voxel / 64] >> (voxel % 64) & 1) != 0;
}

int count(const LeafHead& head) {
  int active = 0;
  for (const std::uint64_t word : head.active) active += std::popcount(word);
  return active;
}

class GridWriter {
 public:
  explicit GridWriter(const FloatGrid& grid) : grid_(grid), background_(grid.background()) {}

  bool collect() {
    const auto& root = grid_.tree().root();
    for (auto tile = root.cbeginValueAll(); tile; ++tile) add_tile(tile, 3);
    for (auto upper = root.cbeginChildOn(); upper; ++upper) {
      bool used = add_negative_tiles(*upper, 2);
      for (auto lower = upper->cbeginChildOn(); lower; ++lower) {
        used = true;
        bool holds = add_negative_tiles(*lower, 1);
        for (auto leaf = lower->cbeginChildOn(); leaf; ++leaf) {
          holds = true;
          add_leaf(*leaf);
        }
        if (!holds) tiles_.push_back({array_of(lower->origin()), 1, 0});
      }
      if (!used) tiles_.push_back({array_of(upper->origin()), 2, 0});
    }
    return plain_;
  }

  void write(ByteWriter& to) const {
    to.values(std::span<const Tile>(tiles_));
    to.values(std::span<const LeafHead>(leaves_));
    to.values(std::span<const float>(values_));
  }

 private:
  bool is_background(float value) const { return std::abs(value) == background_; }

  template <class Iterator>
  bool add_tile(const Iterator& tile, std::uint16_t level) {
    plain_ = plain_ && !tile.isValueOn() && is_background(*tile);
    const bool negative = std::signbit(*tile);
    if (negative || level == 3) tiles_.push_back({array_of(tile.getCoord()), level, negative});
    return negative;
  }

  template <class Node>
  bool add_negative_tiles(const Node& node, std::uint16_t level) {
    bool any = false;
    for (auto tile = node.cbeginValueAll(); tile; ++tile) any |= add_tile(tile, level);
    return any;
  }

  void add_leaf(const Leaf& leaf) {
    LeafHead head{.origin = array_of(leaf.origin())};
    const float* values = leaf.buffer().data();
    for (int word = 0; word < kWords; ++word) {
      head.active[word] = leaf.valueMask().getWord<std::uint64_t>(word);
    }
    for (int voxel = 0; voxel < int(Leaf::SIZE); ++voxel) {
      if (in_set(head.active, voxel)) {
        values_.push_back(values[voxel]);
        plain_ = plain_ && std::isfinite(values[voxel]);
        continue;
      }
      plain_ = plain_ && is_background(values[voxel]);
      const std::uint64_t negative = std::signbit(values[voxel]);
      head.negative[voxel / 64] |= negative << (voxel % 64);
    }
    leaves_.push_back(head);
  }

  const FloatGrid& grid_;
  float background_;
  bool plain_ = true;
  std::vector<Tile> tiles_;
  std::vector<LeafHead> leaves_;
  std::vector<float> values_;
};

std::unique_ptr<Leaf> make_leaf(const LeafHead& head, const char* values, float background) {
  auto leaf = std::make_unique<Leaf>(coord_of(head.origin), background);
  Leaf::NodeMaskType active;
  for (int word = 0; word < kWords; ++word) {
    active.getWord<std::uint64_t>(word) = head.active[word];
  }
  leaf->setValueMask(active);
  float* to = leaf->buffer().data();
  for (int voxel = 0; voxel < int(Leaf::SIZE); ++voxel) {
    if (in_set(head.active, voxel)) {
      std::memcpy(&to[voxel], values, sizeof(float));
      values += sizeof(float);
      expect_bytes(std::isfinite(to[voxel]), "a distance is not finite");
    } else if (in_set(head.negative, voxel)) {
      to[voxel] = -background;
    }
  }
  return leaf;
}

void read_tree(ByteReader& from, Tree& tree) {
  const float background = tree.background();
  for (const Tile& tile : from.values<Tile>()) {
    expect_bytes(tile.level >= 1 && tile.level <= 3, "a tile has no level");
    const float value = tile.negative != 0 ? -background : background;
    tree.addTile(tile.level, coord_of(tile.origin), value, false);
  }
  const auto heads = from.values<LeafHead>();
  const std::string_view values = from.bytes_of<float>();
  std::vector<std::size_t> first(heads.size() + 1);
  for (std::size_t i = 0; i < heads.size(); ++i) {
    first[i + 1] = first[i] + sizeof(float) * static_cast<std::size_t>(count(heads[i]));
  }
  expect_bytes(first.back() == values.size(), "leaves and values do not match");
  std::vector<std::unique_ptr<Leaf>> leaves(heads.size());
  tbb::parallel_for(std::size_t{0}, heads.size(), [&](std::size_t i) {
    leaves[i] = make_leaf(heads[i], values.data() + first[i], background);
  });
  for (auto& leaf : leaves) tree.addLeaf(leaf.release());
}

bool has_only_its_name(const FloatGrid& grid) {
  for (auto entry = grid.beginMeta(); entry != grid.endMeta(); ++entry) {
    if (entry->first != "name" && entry->first != "class") return false;
  }
  return grid.getGridClass() == openvdb::GRID_LEVEL_SET;
}

}  // namespace

bool write_level_set(const FloatGrid& grid, ByteWriter& to) {
  const auto map = grid.transform().baseMap();
  const bool moved = map->type() == UniformScaleTranslateMap::mapType();
  if (!moved && map->type() != UniformScaleMap::mapType()) return false;
  if (!(map->determinant() > 0)) return false;
  const openvdb::Vec3d at =
      moved ? static_cast<const UniformScaleTranslateMap&>(*map).getTranslation()
            : openvdb::Vec3d(0);
  to.text(grid.getName());
  to.value(static_cast<std::uint32_t>(moved));
  for (const double number : {grid.voxelSize()[0], at.x(), at.y(), at.z()}) to.value(number);
  to.value(grid.background());
  GridWriter writer(grid);
  if (!has_only_its_name(grid) || !writer.collect()) return false;
  writer.write(to);
  return true;
}

std::shared_ptr<FloatGrid> read_level_set(ByteReader& from) {
  const std::string name = from.text();
  const bool moved = from.value<std::uint32_t>() != 0;
  std::array<double, 4> numbers{};
  for (double& number : numbers) {
    number = from.value<double>();
    expect_bytes(std::isfinite(number), "a transform is not finite");
  }
  const auto [voxel_m, x, y, z] = numbers;
  const float background = from.value<float>();
  expect_bytes(voxel_m > 1e-9 && voxel_m < 1e3, "no size of a voxel");
  expect_bytes(background > 0 && std::isfinite(background), "no background");
  auto grid = create_level_set(voxel_m, static_cast<double>(background));
  if (moved) {
    grid->setTransform(std::make_shared<openvdb::math::Transform>(openvdb::math::MapBase::Ptr(
        std::make_shared<UniformScaleTranslateMap>(voxel_m, openvdb::Vec3d(x, y, z)))));
  }
  grid->setName(name);
  read_tree(from, grid->tree());
  return grid;
}

}  // namespace wobblebench::phantoms
