#include "phantoms/io/phantom_bytes.h"

#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "base/byte_stream.h"
#include "base/text.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/label_finder.h"

namespace wobblebench::phantoms {
namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
using openvdb::math::UniformScaleMap;
using openvdb::math::UniformScaleTranslateMap;

constexpr int kWords = Leaf::SIZE / 64;
constexpr std::int32_t kFarthest = 1 << 20;  // voxels from the origin: 100 m and more

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
    expect_bytes(along >= -kFarthest && along <= kFarthest, "a voxel is too far away");
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

// Writes a level set whose inactive values are all plus or minus the background, whose voxels are
// scaled alike along all axes and moved at most, and that has no metadata but its name: such as
// this program's shapes. Returns whether it is one; if not, what was written is of no use.
bool write_grid(const FloatGrid& grid, ByteWriter& to) {
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

// The same grid: every value, voxel and tile, and its size in memory. Throws DamagedBytes.
std::shared_ptr<FloatGrid> read_grid(ByteReader& from) {
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

constexpr std::uint32_t kMostEntries = 10000;

void write(ByteWriter& to, const glm::dvec3& v) {
  for (int axis = 0; axis < 3; ++axis) to.value(v[axis]);
}

void write(ByteWriter& to, const Material& material) {
  to.text(material.name);
  to.value(material.sound_speed_m_s);
  to.value(material.impedance_rayl);
  to.value(material.attenuation_db_per_cm_mhz);
  to.value(material.backscatter_db);
  to.value(material.roughness);
  to.text(material.source);
}

void write(ByteWriter& to, const PointScatterers& points) {
  to.value(static_cast<std::uint32_t>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto track = points.track(i);
    to.value(static_cast<std::uint32_t>(track.size()));
    for (const ScattererKey& key : track) {
      to.value(key.time_s);
      write(to, key.point.position_m);
      to.value(key.point.amplitude);
    }
  }
}

void write(ByteWriter& to, const glm::dmat3& matrix) {
  for (int axis = 0; axis < 3; ++axis) write(to, matrix[axis]);
}

void write(ByteWriter& to, const Shape& shape) {
  const auto* ellipsoid = std::get_if<Ellipsoid>(&shape);
  to.value(std::uint32_t{ellipsoid != nullptr ? 1U : 0U});
  if (ellipsoid != nullptr) {
    write(to, ellipsoid->center);
    write(to, ellipsoid->radii_m);
    write(to, ellipsoid->to_axes);
    return;
  }
  const auto& points = std::get<Tube>(shape).points();
  to.value(static_cast<std::uint32_t>(points.size()));
  for (const TubePoint& point : points) {
    write(to, point.center);
    to.value(point.radius_m);
  }
}

void write(ByteWriter& to, Part part) {
  to.value(static_cast<std::uint32_t>(part));
}

void write(ByteWriter& to, const PartBody& body) {
  to.value(static_cast<std::uint32_t>(body.shape.operations().size()));
  for (const CsgBody::Operation& operation : body.shape.operations()) {
    write(to, operation.part);
    to.value(std::uint32_t{operation.is_difference ? 1U : 0U});
    to.value(operation.fillet_m);
    write(to, operation.shape);
  }
  write(to, body.to_body);
  write(to, body.position_m);
  to.value(body.fillet_m);
}

void write(ByteWriter& to, const PhantomParts* parts) {
  to.value(std::uint32_t{parts != nullptr ? 1U : 0U});
  if (parts == nullptr) return;
  write(to, parts->background);
  for (const SurfaceParts& surface : parts->surfaces) {
    write(to, surface.on);
    write(to, surface.inside);
    to.value(static_cast<std::uint32_t>(surface.bodies.size()));
    for (const PartBody& body : surface.bodies) write(to, body);
  }
}

void write(ByteWriter& to, const std::vector<Landmark>& landmarks) {
  to.value(static_cast<std::uint32_t>(landmarks.size()));
  for (const Landmark& landmark : landmarks) {
    to.text(landmark.name);
    write(to, landmark.position_m);
  }
}

void write(ByteWriter& to, const std::vector<PhantomMeasure>& measures) {
  to.value(static_cast<std::uint32_t>(measures.size()));
  for (const PhantomMeasure& measure : measures) {
    to.text(measure.name);
    to.value(measure.value);
    to.value(std::uint32_t{measure.target ? 1U : 0U});
    to.value(measure.target.value_or(0));
  }
}

double number(ByteReader& from) {
  const double value = from.value<double>();
  expect_bytes(std::isfinite(value), "a number is not finite");
  return value;
}

glm::dvec3 vector(ByteReader& from) {
  glm::dvec3 v{};
  for (int axis = 0; axis < 3; ++axis) v[axis] = number(from);
  return v;
}

std::string text(ByteReader& from) {
  std::string text = from.text();
  expect_bytes(is_printable_text(text), "a name is not printable");
  return text;
}

std::uint32_t below(ByteReader& from, std::uint32_t limit) {
  const auto value = from.value<std::uint32_t>();
  expect_bytes(value < limit, "a number is too large");
  return value;
}

std::vector<Material> read_materials(ByteReader& from) {
  std::vector<Material> materials(below(from, kMostEntries));
  for (Material& material : materials) {
    material.name = text(from);
    material.sound_speed_m_s = number(from);
    material.impedance_rayl = number(from);
    material.attenuation_db_per_cm_mhz = number(from);
    material.backscatter_db = number(from);
    material.roughness = number(from);
    material.source = text(from);
  }
  return materials;
}

void write(ByteWriter& to, const Mouth& mouth) {
  for (int axis = 0; axis < 3; ++axis) write(to, mouth.axes[axis]);
  write(to, mouth.center_m);
  to.value(mouth.opening_m);
  to.value(mouth.reach_m);
}

std::optional<Mouth> read_mouth(ByteReader& from) {
  if (below(from, 2) == 0) return std::nullopt;
  Mouth mouth;
  for (int axis = 0; axis < 3; ++axis) mouth.axes[axis] = vector(from);
  mouth.center_m = vector(from);
  mouth.opening_m = number(from);
  mouth.reach_m = number(from);
  expect_bytes(is_possible(mouth), "a mouth cannot move");
  return mouth;
}

std::optional<Joint> read_joint(ByteReader& from) {
  if (below(from, 2) == 0) return std::nullopt;
  const glm::dvec3 center_m = vector(from);
  const double inner_m = number(from), outer_m = number(from);
  const Joint joint{center_m, inner_m, outer_m, read_mouth(from)};
  expect_bytes(joint.inner_m >= 0 && joint.inner_m < joint.outer_m, "a joint is no shell");
  return joint;
}

PointScatterers read_scatterers(ByteReader& from) {
  PointScatterers points;
  for (auto left = from.value<std::uint32_t>(); left > 0; --left) {
    std::vector<ScattererKey> track;
    for (auto keys = from.value<std::uint32_t>(); keys > 0; --keys) {
      const double time_s = number(from);
      const glm::dvec3 position_m = vector(from);
      const double amplitude = number(from);
      expect_bytes(track.empty() || time_s > track.back().time_s, "a track's times do not rise");
      track.push_back({time_s, {position_m, amplitude}});
    }
    expect_bytes(!track.empty(), "a track has no keys");
    points.add_track(track);
  }
  return points;
}

glm::dmat3 matrix(ByteReader& from) {
  glm::dmat3 matrix;
  for (int axis = 0; axis < 3; ++axis) matrix[axis] = vector(from);
  return matrix;
}

double positive(ByteReader& from) {
  const double value = number(from);
  expect_bytes(value > 0, "a size is not positive");
  return value;
}

Shape read_shape(ByteReader& from) {
  if (below(from, 2) == 1) {
    Ellipsoid ellipsoid;
    ellipsoid.center = vector(from);
    for (int axis = 0; axis < 3; ++axis) ellipsoid.radii_m[axis] = positive(from);
    ellipsoid.to_axes = matrix(from);
    return ellipsoid;
  }
  std::vector<TubePoint> points(below(from, kMostEntries));
  expect_bytes(points.size() > 1, "a tube has no length");
  for (TubePoint& point : points) {
    point.center = vector(from);
    point.radius_m = positive(from);
  }
  return Tube(std::move(points));
}

Part read_part(ByteReader& from) {
  const auto part = static_cast<Part>(below(from, 256));
  const bool is_known = std::ranges::any_of(
      part_names(), [part](const PartName& known) { return known.part == part; });
  expect_bytes(is_known || part == Part::none, "a part is not known");
  return part;
}

PartBody read_body(ByteReader& from) {
  PartBody body;
  for (std::uint32_t left = below(from, kMostEntries); left > 0; --left) {
    body.shape.begin(read_part(from));
    const bool is_difference = below(from, 2) == 1;
    const double fillet_m = number(from);
    const Shape shape = read_shape(from);
    is_difference ? body.shape.subtract(shape, fillet_m) : body.shape.unite(shape, fillet_m);
  }
  body.to_body = matrix(from);
  body.position_m = vector(from);
  body.fillet_m = number(from);
  return body;
}

std::optional<PhantomParts> read_parts(ByteReader& from, std::size_t surfaces) {
  if (below(from, 2) == 0) return std::nullopt;
  PhantomParts parts;
  parts.background = read_part(from);
  parts.surfaces.resize(surfaces);
  for (SurfaceParts& surface : parts.surfaces) {
    surface.on = read_part(from);
    surface.inside = read_part(from);
    for (std::uint32_t left = below(from, kMostEntries); left > 0; --left) {
      surface.bodies.push_back(read_body(from));
    }
  }
  return parts;
}

std::vector<Landmark> read_landmarks(ByteReader& from) {
  std::vector<Landmark> landmarks(below(from, kMostEntries));
  for (Landmark& landmark : landmarks) {
    landmark.name = text(from);
    landmark.position_m = vector(from);
  }
  return landmarks;
}

std::vector<PhantomMeasure> read_measures(ByteReader& from) {
  std::vector<PhantomMeasure> measures(below(from, kMostEntries));
  for (PhantomMeasure& measure : measures) {
    measure.name = text(from);
    measure.value = number(from);
    const bool aimed = below(from, 2) == 1;
    const double target = number(from);
    if (aimed) measure.target = target;
  }
  return measures;
}

}  // namespace

std::optional<std::string> to_bytes(const Phantom& phantom) {
  ByteWriter to;
  to.text(phantom.name());
  to.value(static_cast<std::uint32_t>(phantom.materials().size()));
  for (const Material& material : phantom.materials()) write(to, material);
  to.value(static_cast<std::uint32_t>(phantom.background()));
  write(to, phantom.region_of_interest().low);
  write(to, phantom.region_of_interest().high);
  write(to, phantom.suggested_position_m());
  to.value(std::uint32_t{phantom.joint() ? 1U : 0U});
  if (const auto& joint = phantom.joint()) {
    write(to, joint->center_m);
    to.value(joint->inner_m);
    to.value(joint->outer_m);
    to.value(std::uint32_t{joint->mouth ? 1U : 0U});
    if (joint->mouth) write(to, *joint->mouth);
  }
  to.value(static_cast<std::uint32_t>(phantom.surfaces().size()));
  for (std::size_t i = 0; i < phantom.surfaces().size(); ++i) {
    const Surface& surface = phantom.surfaces()[i];
    to.text(surface.name);
    to.value(static_cast<std::uint32_t>(surface.inside));
    to.value(std::uint32_t{surface.is_target ? 1U : 0U});
    if (!write_grid(*phantom.grids().signed_distance[i], to)) return std::nullopt;
  }
  write(to, phantom.scatterers());
  write(to, phantom.parts());
  write(to, phantom.landmarks());
  write(to, phantom.measures());
  return to.take();
}

Phantom phantom_from_bytes(std::string_view bytes) {
  ByteReader from(bytes);
  std::string name = text(from);
  std::vector<Material> materials = read_materials(from);
  const auto rows = static_cast<std::uint32_t>(materials.size());
  const auto background = static_cast<MaterialIndex>(below(from, rows));
  Box region;
  region.low = vector(from);
  region.high = vector(from);
  const glm::dvec3 position_m = vector(from);
  const std::optional<Joint> joint = read_joint(from);
  std::vector<Surface> surfaces(below(from, kMostEntries));
  auto grids = std::make_shared<Grids>();
  for (Surface& surface : surfaces) {
    surface.name = text(from);
    surface.inside = static_cast<MaterialIndex>(below(from, rows));
    surface.is_target = below(from, 2) == 1;
    grids->signed_distance.push_back(read_grid(from));
  }
  PointScatterers points = read_scatterers(from);
  std::optional<PhantomParts> parts = read_parts(from, surfaces.size());
  std::vector<Landmark> landmarks = read_landmarks(from);
  std::vector<PhantomMeasure> measures = read_measures(from);
  from.expect_end();
  Phantom phantom = Phantom(std::move(name),
                            std::move(materials),
                            background,
                            std::move(surfaces),
                            region,
                            position_m,
                            std::move(grids),
                            joint,
                            std::move(points))
                        .with_measures(std::move(measures));
  if (!parts) return phantom;
  return phantom.with_parts(*std::move(parts), std::move(landmarks));
}

}  // namespace wobblebench::phantoms
