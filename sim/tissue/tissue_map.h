// What lies where, for those who ask millions of times: a phantom's level sets resampled onto one
// lattice of cells. Most cells hold one material and cost nothing; the others know the signed
// distance of each surface nearby. OpenVDB stays in the .cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::sim {

/// Immutable after construction; const functions may be called from any thread. All places are in
/// the phantom frame at rest, in metres.
class TissueMap {
 public:
  /// Surfaces and materials are numbered in a byte: a stick waits for its cells and entries to come
  /// from memory, and eight of them fit what comes at once.
  static constexpr int kMostSurfaces = 255;

  /// A surface that comes within reach of a cell. Entries of a cell are in painter's order: where
  /// `distance` is negative, `inside` replaces what came before.
  struct Entry {
    std::uint32_t block = 0;  ///< where its nodes begin, in lines of nodes
    std::uint8_t surface = 0;
    std::uint8_t inside = 0;     ///< a phantoms::MaterialIndex
    std::uint8_t divisions = 0;  ///< of the cell's side; the block has (divisions + 1)^3 nodes
  };
  struct Cell {
    std::uint32_t first = 0;    ///< of the entries
    std::uint8_t count = 0;     ///< none: the cell is all `base`
    std::uint8_t base = 0;      ///< the material that lies there but for the entries
    std::uint8_t material = 0;  ///< of all of a cell that is not crossed
    bool crossed = false;       ///< a surface passes through it
  };
  struct Distance {
    float value_m = 0;  ///< negative inside; at least `reach` away it is only a bound
    glm::vec3 gradient{0};
  };

  /// `reach_m`: distances are known at least this far from each surface.
  TissueMap(const phantoms::Phantom& phantom, double reach_m, int threads);

  double cell_m() const { return cell_m_; }
  double step_m() const { return step_m_; }  ///< between nodes where a surface passes
  double reach_m() const { return reach_m_; }
  const glm::dvec3& origin_m() const { return origin_m_; }  ///< low corner of cell (0, 0, 0)
  const glm::ivec3& cells() const { return cells_; }        ///< in each direction

  /// The cell that holds a place; beyond the lattice everything is background.
  glm::ivec3 cell_at(const glm::dvec3& rest_m) const;
  const Cell& cell(const glm::ivec3& index) const;
  std::span<const Entry> entries(const Cell& cell) const {
    return {entries_.data() + cell.first, cell.count};
  }
  /// Trilinear distance and its gradient; `local` is the place in the cell, 0 to 1 in each axis.
  Distance distance(const Entry& entry, const glm::vec3& local) const;

  /// Distances along a straight line of places, each with its gradient along three directions.
  struct Line {
    glm::vec3 begin;   ///< in the cell, as above
    glm::vec3 stride;  ///< from one place to the next
    glm::vec3 axial;
    glm::vec3 lateral;
    glm::vec3 elevation;
  };
  struct LineNode {
    float value_m = 0;
    float axial = 0;
    float lateral = 0;
    float elevation = 0;
  };
  void trace(const Entry& entry, const Line& line, int count, LineNode* nodes) const;

  /// Asks for a cell's entries, so that they are there when they are looked at.
  void prefetch(const Cell& cell) const { __builtin_prefetch(entries_.data() + cell.first); }
  /// Asks for an entry's nodes.
  void prefetch(const Entry& entry) const {
    const int nodes = (entry.divisions + 1) * (entry.divisions + 1) * (entry.divisions + 1);
    const NodeLine* line = nodes_.data() + entry.block;
    for (int i = 0; i < nodes; i += kLineNodes) __builtin_prefetch(line++);
  }

  /// The distance alone.
  float value_m(const Entry& entry, const glm::vec3& local) const;

  phantoms::MaterialIndex material(const glm::dvec3& rest_m) const;
  /// Unit normal of a surface near a place, outwards: central differences over a fine step, which
  /// unlike the gradient of one cell know the neighbours. Zero where the surface is out of reach.
  glm::dvec3 normal(std::int32_t surface, const glm::dvec3& rest_m) const;
  std::size_t bytes() const;

 private:
  friend class TissueMapBuilder;

  /// Distances in units of `unit_m_`, as whole numbers, x fastest within a block: half of what they
  /// would be in memory as floats, and a block begins where what comes from memory at once does.
  static constexpr int kLineNodes = 32;
  struct alignas(64) NodeLine {
    std::array<std::int16_t, kLineNodes> values{};
  };
  const std::int16_t* nodes(const Entry& entry) const { return nodes_[entry.block].values.data(); }

  double cell_m_ = 1;
  double step_m_ = 1;
  double reach_m_ = 0;
  glm::dvec3 origin_m_{0};
  glm::ivec3 cells_{0};
  Cell outside_;
  std::vector<Cell> lattice_;  ///< x fastest
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
  // Differences of whole numbers are exact.
  const auto between = [u](const std::int16_t* node) {
    return static_cast<float>(node[0]) + u * static_cast<float>(node[1] - node[0]);
  };
  const float c00 = between(near), c10 = between(near + row);
  const float c01 = between(far), c11 = between(far + row);
  const float c0 = c00 + v * (c10 - c00), c1 = c01 + v * (c11 - c01);
  return unit_m_ * (c0 + w * (c1 - c0));
}

}  // namespace wobblebench::sim
