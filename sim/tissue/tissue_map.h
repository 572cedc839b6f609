// A phantom's level sets resampled onto one uniform grid of cells, for fast look-up of materials
// and signed distances. Most cells hold one material; the others store samples of the signed
// distance to each surface within reach. OpenVDB is used by tissue_map_builder.cpp only.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "phantoms/material.h"

namespace wobblebench::phantoms {
class Phantom;
}

namespace wobblebench::sim {

struct TrackNode;

/// Immutable after construction; const functions may be called from any thread. Positions are in
/// the phantom frame at rest, in metres.
class TissueMap {
 public:
  /// Surfaces and materials are numbered in a byte, so that eight cells or entries fit a cache
  /// line: tracing a stick is limited by memory latency.
  static constexpr int kMaxSurfaces = 255;

  /// A surface within reach of a cell. A cell's entries are in painter's order: where the distance
  /// is negative, `inside` replaces the material of the entries before it.
  struct Entry {
    std::uint32_t first_line = 0;  ///< of its nodes, an index of NodeLine
    std::uint8_t surface = 0;
    std::uint8_t inside = 0;     ///< a phantoms::MaterialIndex
    std::uint8_t divisions = 0;  ///< of the cell's side; there are (divisions + 1)^3 nodes
  };
  struct Cell {
    std::uint32_t first = 0;    ///< index of its first entry
    std::uint8_t count = 0;     ///< number of entries; 0: the whole cell is of the material `base`
    std::uint8_t base = 0;      ///< material outside all its entries
    std::uint8_t material = 0;  ///< of the whole cell, if it is not crossed
    bool crossed = false;       ///< a surface passes through it
  };
  struct Distance {
    float value_m = 0;  ///< negative inside; beyond reach_m() only a lower bound of the magnitude
    glm::vec3 gradient{0};
  };

  /// Distances are stored at least up to `reach_m` from each surface. Throws std::runtime_error if
  /// the phantom has more than kMaxSurfaces surfaces or materials, or needs too many cells.
  TissueMap(const phantoms::Phantom& phantom, double reach_m, int threads);

  double cell_m() const { return cell_m_; }
  double step_m() const { return step_m_; }  ///< between nodes of a crossed cell
  double reach_m() const { return reach_m_; }
  const glm::dvec3& origin_m() const { return origin_m_; }  ///< low corner of cell (0, 0, 0)
  const glm::ivec3& cells() const { return cells_; }        ///< number along each axis

  /// Index of the cell that contains a position; cells outside the grid are background.
  glm::ivec3 cell_at(const glm::dvec3& rest_m) const;
  const Cell& cell(const glm::ivec3& index) const;
  std::span<const Entry> entries(const Cell& cell) const {
    return {entries_.data() + cell.first, cell.count};
  }
  /// Trilinear distance and its gradient. `local`: position in the cell, 0 to 1 along each axis.
  Distance distance(const Entry& entry, const glm::vec3& local) const;

  /// Equidistant positions on a straight line through a cell, and the three directions along which
  /// derivatives are taken.
  struct Line {
    glm::vec3 begin;   ///< in the cell, 0 to 1 along each axis
    glm::vec3 stride;  ///< from one position to the next
    glm::vec3 axial;
    glm::vec3 lateral;
    glm::vec3 elevation;
  };
  /// Trilinear distance and its directional derivatives at `count` positions.
  void trace(const Entry& entry, const Line& line, int count, TrackNode* nodes) const;

  /// Prefetches a cell's entries into the cache.
  void prefetch(const Cell& cell) const { __builtin_prefetch(entries_.data() + cell.first); }
  /// Prefetches an entry's nodes.
  void prefetch(const Entry& entry) const {
    const int nodes = (entry.divisions + 1) * (entry.divisions + 1) * (entry.divisions + 1);
    const NodeLine* line = nodes_.data() + entry.first_line;
    for (int i = 0; i < nodes; i += kLineNodes) __builtin_prefetch(line++);
  }

  /// Trilinear distance without its gradient.
  float value_m(const Entry& entry, const glm::vec3& local) const;

  phantoms::MaterialIndex material(const glm::dvec3& rest_m) const;
  /// Outward unit normal of a surface near a position, by central differences over one step, which
  /// unlike the gradient within one cell also use its neighbours. Zero where the surface is out of
  /// reach.
  glm::dvec3 normal(std::int32_t surface, const glm::dvec3& rest_m) const;
  std::size_t bytes() const;

 private:
  friend class TissueMapBuilder;
  friend class TissueMapBytes;
  TissueMap() = default;

  /// Distances are stored as integers in units of `unit_m_`, half the size of floats, x fastest.
  /// Each entry's nodes begin on a cache line.
  static constexpr int kLineNodes = 32;
  struct alignas(64) NodeLine {
    std::array<std::int16_t, kLineNodes> values{};
  };
  const std::int16_t* nodes(const Entry& entry) const {
    return nodes_[entry.first_line].values.data();
  }

  double cell_m_ = 1;
  double step_m_ = 1;
  double reach_m_ = 0;
  glm::dvec3 origin_m_{0};
  glm::ivec3 cells_{0};
  Cell outside_;            ///< any cell outside the grid
  std::vector<Cell> grid_;  ///< x fastest
  std::vector<Entry> entries_;
  float unit_m_ = 0;  ///< of the nodes
  std::vector<NodeLine> nodes_;
};

inline float TissueMap::value_m(const Entry& entry, const glm::vec3& local) const {
  const int n = entry.divisions;
  const float scale = static_cast<float>(n);
  const float px = local.x * scale, py = local.y * scale, pz = local.z * scale;
  const int x = std::clamp(static_cast<int>(px), 0, n - 1);
  const int y = std::clamp(static_cast<int>(py), 0, n - 1);
  const int z = std::clamp(static_cast<int>(pz), 0, n - 1);
  const float u = px - static_cast<float>(x);
  const float v = py - static_cast<float>(y);
  const float w = pz - static_cast<float>(z);
  const std::ptrdiff_t row = n + 1;
  const std::int16_t* near = nodes(entry) + (z * row + y) * row + x;
  const std::int16_t* far = near + row * row;
  // Differences of integers are exact.
  const auto between = [u](const std::int16_t* node) {
    return static_cast<float>(node[0]) + u * static_cast<float>(node[1] - node[0]);
  };
  const float c00 = between(near), c10 = between(near + row);
  const float c01 = between(far), c11 = between(far + row);
  const float c0 = c00 + v * (c10 - c00), c1 = c01 + v * (c11 - c01);
  return unit_m_ * (c0 + w * (c1 - c0));
}

/// Version of to_bytes(), for caches; it increases when the format or the contents of a map change.
inline constexpr int kTissueMapBytesVersion = 1;

[[nodiscard]] std::string to_bytes(const TissueMap& map);

/// The map that to_bytes() wrote, bit for bit, for a phantom with these numbers of surfaces and
/// materials. Throws DamagedBytes where an index lies beyond an array; values within their bounds
/// are not checked.
[[nodiscard]] std::shared_ptr<const TissueMap> tissue_map_from_bytes(std::string_view bytes,
                                                                     std::size_t surfaces,
                                                                     std::size_t materials);

}  // namespace wobblebench::sim
