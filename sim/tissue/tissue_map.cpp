#include "sim/tissue/tissue_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "sim/math/fast_math.h"
#include "sim/tissue/stick_track.h"

namespace wobblebench::sim {

namespace {

/// std::floor is a function call without SSE4.1.
inline glm::ivec3 floored(const glm::dvec3& position) {
  const glm::ivec3 whole(position);
  return whole - glm::ivec3(glm::lessThan(position, glm::dvec3(whole)));
}

}  // namespace

glm::ivec3 TissueMap::cell_at(const glm::dvec3& rest_m) const {
  return floored((rest_m - origin_m_) / cell_m_);
}

const TissueMap::Cell& TissueMap::cell(const glm::ivec3& index) const {
  const bool within = index.x >= 0 && index.y >= 0 && index.z >= 0 && index.x < cells_.x &&
                      index.y < cells_.y && index.z < cells_.z;
  if (!within) return outside_;
  return grid_[(static_cast<std::size_t>(index.z) * cells_.y + index.y) * cells_.x + index.x];
}

TissueMap::Distance TissueMap::distance(const Entry& entry, const glm::vec3& local) const {
  const int n = entry.divisions;
  const glm::vec3 position = local * static_cast<float>(n);
  const int x = std::clamp(static_cast<int>(position.x), 0, n - 1);
  const int y = std::clamp(static_cast<int>(position.y), 0, n - 1);
  const int z = std::clamp(static_cast<int>(position.z), 0, n - 1);
  const float u = position.x - static_cast<float>(x);
  const float v = position.y - static_cast<float>(y);
  const float w = position.z - static_cast<float>(z);
  const std::size_t row = static_cast<std::size_t>(n) + 1;
  const std::int16_t* first = nodes(entry) + (static_cast<std::size_t>(z) * row + y) * row + x;
  const auto at = [first](std::size_t node) { return static_cast<float>(first[node]); };
  const std::size_t above = row * row;
  // Along x on the four edges, then along y on both faces, then along z.
  const float dx00 = at(1) - at(0), dx10 = at(row + 1) - at(row);
  const float dx01 = at(above + 1) - at(above), dx11 = at(above + row + 1) - at(above + row);
  const float c00 = at(0) + u * dx00, c10 = at(row) + u * dx10;
  const float c01 = at(above) + u * dx01, c11 = at(above + row) + u * dx11;
  const float c0 = c00 + v * (c10 - c00), c1 = c01 + v * (c11 - c01);
  const float unit_per_m = unit_m_ * static_cast<float>(n / cell_m_);
  const float gx = (1 - w) * ((1 - v) * dx00 + v * dx10) + w * ((1 - v) * dx01 + v * dx11);
  const float gy = (1 - w) * (c10 - c00) + w * (c11 - c01);
  return {unit_m_ * (c0 + w * (c1 - c0)), unit_per_m * glm::vec3(gx, gy, c1 - c0)};
}

phantoms::MaterialIndex TissueMap::material(const glm::dvec3& rest_m) const {
  const glm::ivec3 index = cell_at(rest_m);
  const Cell& found = cell(index);
  const glm::vec3 local((rest_m - origin_m_) / cell_m_ - glm::dvec3(index));
  phantoms::MaterialIndex result = found.base;
  for (const Entry& entry : entries(found)) {
    if (value_m(entry, local) < 0) result = entry.inside;
  }
  return result;
}

glm::dvec3 TissueMap::normal(std::int32_t surface, const glm::dvec3& rest_m) const {
  const auto entry_in = [&](const glm::ivec3& index) -> const Entry* {
    for (const Entry& entry : entries(cell(index))) {
      if (entry.surface == surface) return &entry;
    }
    return nullptr;
  };
  const glm::dvec3 middle = (rest_m - origin_m_) / cell_m_;  // in cells
  const glm::ivec3 home = floored(middle);
  const Entry* entry_at_home = entry_in(home);
  // Six positions. The four of a tetrahedron would suffice, but they mistake curvature for slope:
  // an error of 0.3 degrees on a sphere of 20 mm instead of 0.005.
  const double away = step_m_ / cell_m_;
  glm::dvec3 rise(0);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double step : {away, -away}) {
      glm::dvec3 position = middle;
      position[axis] += step;
      const glm::ivec3 index = floored(position);
      const Entry* entry = index == home ? entry_at_home : entry_in(index);
      if (entry == nullptr) return glm::dvec3(0);
      rise[axis] += step * static_cast<double>(value_m(*entry, position - glm::dvec3(index)));
    }
  }
  const double length = glm::length(rise);
  return length > 0 ? rise / length : glm::dvec3(0);
}

std::size_t TissueMap::bytes() const {
  return grid_.size() * sizeof(Cell) + entries_.size() * sizeof(Entry) +
         nodes_.size() * sizeof(NodeLine);
}

namespace {

/// The nodes of one entry.
struct EntryNodes {
  const std::int16_t* nodes;
  std::int32_t divisions;
  float unit_m;      ///< of the nodes
  float unit_per_m;  ///< slope of a difference of 1 between adjacent nodes
};

constexpr int kTraceLanes = 8;

/// Positions among the nodes: index of the node below, and fractions of the distance to the next.
struct NodePositions {
  std::int32_t at[kTraceLanes];
  float u[kTraceLanes], v[kTraceLanes], w[kTraceLanes];
};

WOBBLEBENCH_INLINE void locate_lanes(const EntryNodes& entry_nodes,
                                     const TissueMap::Line& line,
                                     int first,
                                     NodePositions& __restrict positions) {
  const std::int32_t n = entry_nodes.divisions, row = n + 1, layer = row * row;
  const float scale = static_cast<float>(n);
  const glm::vec3 begin = line.begin * scale, stride = line.stride * scale;
  for (int i = 0; i < kTraceLanes; ++i) {
    const float step = static_cast<float>(first + i);
    const float px = begin.x + step * stride.x, py = begin.y + step * stride.y,
                pz = begin.z + step * stride.z;
    const std::int32_t ix = static_cast<std::int32_t>(px), iy = static_cast<std::int32_t>(py),
                       iz = static_cast<std::int32_t>(pz);
    const std::int32_t x = ix < 0 ? 0 : ix > n - 1 ? n - 1 : ix;
    const std::int32_t y = iy < 0 ? 0 : iy > n - 1 ? n - 1 : iy;
    const std::int32_t z = iz < 0 ? 0 : iz > n - 1 ? n - 1 : iz;
    positions.u[i] = px - static_cast<float>(x);
    positions.v[i] = py - static_cast<float>(y);
    positions.w[i] = pz - static_cast<float>(z);
    positions.at[i] = z * layer + y * row + x;
  }
}

/// The nodes at both ends of the four edges along x, copied as pairs: a vectorised loop would
/// gather each separately.
struct NodePairs {
  std::int32_t edges[4][kTraceLanes];
};

/// Two adjacent nodes as one word, and each of them.
WOBBLEBENCH_INLINE std::int32_t pair_at(const std::int16_t* node) {
  static_assert(std::endian::native == std::endian::little, "the first node is the low half");
  std::int32_t pair = 0;
  std::memcpy(&pair, node, sizeof pair);
  return pair;
}
WOBBLEBENCH_INLINE float first_of(std::int32_t pair) {
  return static_cast<float>(static_cast<std::int32_t>(static_cast<std::uint32_t>(pair) << 16) >>
                            16);
}
WOBBLEBENCH_INLINE float second_of(std::int32_t pair) {
  return static_cast<float>(pair >> 16);
}

void gather_lanes(const EntryNodes& entry_nodes,
                  const NodePositions& positions,
                  int count,
                  NodePairs& pairs) {
  const std::ptrdiff_t row = entry_nodes.divisions + 1, layer = row * row;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::int16_t* node = entry_nodes.nodes + positions.at[i];
    pairs.edges[0][i] = pair_at(node);
    pairs.edges[1][i] = pair_at(node + row);
    pairs.edges[2][i] = pair_at(node + layer);
    pairs.edges[3][i] = pair_at(node + layer + row);
  }
}

/// trace() for one vector of positions.
WOBBLEBENCH_INLINE void trace_lanes(const NodePairs& pairs,
                                    const NodePositions& positions,
                                    const TissueMap::Line& line,
                                    const EntryNodes& entry_nodes,
                                    float (&values)[4][kTraceLanes]) {
  for (int i = 0; i < kTraceLanes; ++i) {
    const float u = positions.u[i], v = positions.v[i], w = positions.w[i];
    const std::int32_t p00 = pairs.edges[0][i], p10 = pairs.edges[1][i];
    const std::int32_t p01 = pairs.edges[2][i], p11 = pairs.edges[3][i];
    const float a000 = first_of(p00), a010 = first_of(p10);
    const float a001 = first_of(p01), a011 = first_of(p11);
    // Along x on the four edges, then along y on both faces, then along z.
    const float dx00 = second_of(p00) - a000, dx10 = second_of(p10) - a010;
    const float dx01 = second_of(p01) - a001, dx11 = second_of(p11) - a011;
    const float c00 = a000 + u * dx00, c10 = a010 + u * dx10;
    const float c01 = a001 + u * dx01, c11 = a011 + u * dx11;
    const float c0 = c00 + v * (c10 - c00), c1 = c01 + v * (c11 - c01);
    const float gx = entry_nodes.unit_per_m *
                     ((1 - w) * ((1 - v) * dx00 + v * dx10) + w * ((1 - v) * dx01 + v * dx11));
    const float gy = entry_nodes.unit_per_m * ((1 - w) * (c10 - c00) + w * (c11 - c01));
    const float gz = entry_nodes.unit_per_m * (c1 - c0);
    values[0][i] = entry_nodes.unit_m * (c0 + w * (c1 - c0));
    values[1][i] = gx * line.axial.x + gy * line.axial.y + gz * line.axial.z;
    values[2][i] = gx * line.lateral.x + gy * line.lateral.y + gz * line.lateral.z;
    values[3][i] = gx * line.elevation.x + gy * line.elevation.y + gz * line.elevation.z;
  }
}

WOBBLEBENCH_SIMD void trace_entry(const EntryNodes& entry_nodes,
                                  const TissueMap::Line& line,
                                  int count,
                                  TrackNode* to) {
  NodePositions positions;
  NodePairs pairs{};
  float values[4][kTraceLanes];
  for (int first = 0; first < count; first += kTraceLanes) {
    const int used = std::min(kTraceLanes, count - first);
    locate_lanes(entry_nodes, line, first, positions);
    gather_lanes(entry_nodes, positions, used, pairs);
    trace_lanes(pairs, positions, line, entry_nodes, values);
    for (int i = 0; i < used; ++i) {
      to[first + i] = {values[0][i], values[1][i], values[2][i], values[3][i]};
    }
  }
}

}  // namespace

void TissueMap::trace(const Entry& entry, const Line& line, int count, TrackNode* to) const {
  const auto per_m = static_cast<float>(entry.divisions / cell_m_);
  trace_entry({nodes(entry), entry.divisions, unit_m_, unit_m_ * per_m}, line, count, to);
}

}  // namespace wobblebench::sim
