#include "sim/tissue/tissue_map.h"

#include <cmath>
#include <initializer_list>
#include <span>

#include "base/byte_stream.h"

namespace wobblebench::sim {

namespace {

/// A cell or an entry without padding, and without a bool that bytes may set to 2.
struct CellBytes {
  std::uint32_t first = 0;
  std::uint8_t count = 0;
  std::uint8_t base = 0;
  std::uint8_t material = 0;
  std::uint8_t crossed = 0;
};
struct EntryBytes {
  std::uint32_t first_line = 0;
  std::uint8_t surface = 0;
  std::uint8_t inside = 0;
  std::uint8_t divisions = 0;
  std::uint8_t unused = 0;
};

CellBytes bytes_of(const TissueMap::Cell& cell) {
  return {cell.first,
          cell.count,
          cell.base,
          cell.material,
          cell.crossed ? std::uint8_t{1} : std::uint8_t{0}};
}

EntryBytes bytes_of(const TissueMap::Entry& entry) {
  return {entry.first_line, entry.surface, entry.inside, entry.divisions};
}

double positive(ByteReader& from) {
  const double value = from.value<double>();
  expect_bytes(std::isfinite(value) && value > 0, "a length is not positive");
  return value;
}

}  // namespace

/// Writes and reads a map's members.
class TissueMapBytes {
 public:
  static std::string write(const TissueMap& map) {
    ByteWriter to;
    for (const double length : {map.cell_m_, map.step_m_, map.reach_m_}) to.value(length);
    for (int axis = 0; axis < 3; ++axis) {
      to.value(map.origin_m_[axis]);
      to.value(std::int32_t{map.cells_[axis]});
    }
    to.value(bytes_of(map.outside_));
    to.value(map.unit_m_);
    std::vector<CellBytes> cells;
    cells.reserve(map.grid_.size());
    for (const auto& cell : map.grid_) cells.push_back(bytes_of(cell));
    std::vector<EntryBytes> entries;
    entries.reserve(map.entries_.size());
    for (const auto& entry : map.entries_) entries.push_back(bytes_of(entry));
    to.values(std::span<const CellBytes>(cells));
    to.values(std::span<const EntryBytes>(entries));
    to.values(std::span<const TissueMap::NodeLine>(map.nodes_));
    return to.take();
  }

  TissueMapBytes(std::string_view bytes, std::size_t surfaces, std::size_t materials)
      : from_(bytes), surfaces_(surfaces), materials_(materials) {}

  std::shared_ptr<const TissueMap> read() {
    const std::shared_ptr<TissueMap> map(new TissueMap);
    read_shape(*map);
    const auto cells = from_.values<CellBytes>();
    const auto entries = from_.values<EntryBytes>();
    map->nodes_ = from_.values<TissueMap::NodeLine>();
    from_.expect_end();
    expect_bytes(cells.size() == cell_count(map->cells_), "cells and their number do not match");
    map->grid_.reserve(cells.size());
    for (const auto& bytes : cells) map->grid_.push_back(cell(bytes, entries.size()));
    map->entries_.reserve(entries.size());
    for (const auto& bytes : entries) map->entries_.push_back(entry(bytes, map->nodes_.size()));
    return map;
  }

 private:
  void read_shape(TissueMap& map) {
    map.cell_m_ = positive(from_);
    map.step_m_ = positive(from_);
    map.reach_m_ = from_.value<double>();
    expect_bytes(std::isfinite(map.reach_m_) && map.reach_m_ >= 0, "a reach is negative");
    for (int axis = 0; axis < 3; ++axis) {
      map.origin_m_[axis] = from_.value<double>();
      map.cells_[axis] = from_.value<std::int32_t>();
      expect_bytes(std::isfinite(map.origin_m_[axis]), "an origin is not finite");
      expect_bytes(map.cells_[axis] >= 0 && map.cells_[axis] < kMostCells, "too many cells");
    }
    map.outside_ = cell(from_.value<CellBytes>(), 0);
    map.unit_m_ = from_.value<float>();
    expect_bytes(std::isfinite(map.unit_m_), "a unit is not finite");
  }

  static std::size_t cell_count(const glm::ivec3& cells) {
    return static_cast<std::size_t>(cells.x) * static_cast<std::size_t>(cells.y) *
           static_cast<std::size_t>(cells.z);
  }

  TissueMap::Cell cell(const CellBytes& bytes, std::size_t entries) const {
    expect_bytes(std::size_t{bytes.first} + bytes.count <= entries, "a cell has no such entries");
    expect_bytes(bytes.base < materials_ && bytes.material < materials_ && bytes.crossed < 2,
                 "a cell has no such material");
    return {bytes.first, bytes.count, bytes.base, bytes.material, bytes.crossed == 1};
  }

  TissueMap::Entry entry(const EntryBytes& bytes, std::size_t lines) const {
    const std::size_t row = std::size_t{bytes.divisions} + 1;
    const std::size_t needed =
        (row * row * row + TissueMap::kLineNodes - 1) / TissueMap::kLineNodes;
    expect_bytes(bytes.divisions > 0 && bytes.first_line + needed <= lines,
                 "an entry has no such nodes");
    expect_bytes(bytes.surface < surfaces_ && bytes.inside < materials_,
                 "an entry has no such surface");
    return {bytes.first_line, bytes.surface, bytes.inside, bytes.divisions};
  }

  static constexpr std::int32_t kMostCells = 1 << 20;  ///< along an axis: their product fits

  ByteReader from_;
  std::size_t surfaces_;
  std::size_t materials_;
};

std::string to_bytes(const TissueMap& map) {
  return TissueMapBytes::write(map);
}

std::shared_ptr<const TissueMap> tissue_map_from_bytes(std::string_view bytes,
                                                       std::size_t surfaces,
                                                       std::size_t materials) {
  return TissueMapBytes(bytes, surfaces, materials).read();
}

}  // namespace wobblebench::sim
