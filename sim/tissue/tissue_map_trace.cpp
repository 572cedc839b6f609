// Distances along a line through a cell, several places at a time.
#include <algorithm>
#include <bit>
#include <cstring>

#include "sim/math/simd.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

namespace {

struct TraceBlock {
  const std::int16_t* nodes;
  std::int32_t divisions;
  float unit_m;      ///< of the nodes
  float unit_per_m;  ///< of a difference between two nodes, as a slope
};

constexpr int kTraceLanes = 8;

/// Where places lie among the nodes: the node below, and the shares of the way to the next.
struct NodePlaces {
  std::int32_t at[kTraceLanes];
  float u[kTraceLanes], v[kTraceLanes], w[kTraceLanes];
};

WOBBLEBENCH_INLINE void place_lanes(const TraceBlock& block,
                                    const TissueMap::Line& line,
                                    int first,
                                    NodePlaces& __restrict places) {
  const std::int32_t n = block.divisions, row = n + 1, layer = row * row;
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
    places.u[i] = px - static_cast<float>(x);
    places.v[i] = py - static_cast<float>(y);
    places.w[i] = pz - static_cast<float>(z);
    places.at[i] = z * layer + y * row + x;
  }
}

/// The nodes on both ends of the four edges along x, moved together: a wide loop would read them
/// one by one.
struct NodePairs {
  std::int32_t edges[4][kTraceLanes];
};

/// Two nodes next to each other as one word, and one of them.
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

void gather_lanes(const TraceBlock& block, const NodePlaces& places, int count, NodePairs& pairs) {
  const std::ptrdiff_t row = block.divisions + 1, layer = row * row;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::int16_t* node = block.nodes + places.at[i];
    pairs.edges[0][i] = pair_at(node);
    pairs.edges[1][i] = pair_at(node + row);
    pairs.edges[2][i] = pair_at(node + layer);
    pairs.edges[3][i] = pair_at(node + layer + row);
  }
}

/// trace() for a block of places.
WOBBLEBENCH_INLINE void trace_lanes(const NodePairs& pairs,
                                    const NodePlaces& places,
                                    const TissueMap::Line& line,
                                    const TraceBlock& block,
                                    float (&values)[4][kTraceLanes]) {
  for (int i = 0; i < kTraceLanes; ++i) {
    const float u = places.u[i], v = places.v[i], w = places.w[i];
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
    const float gx = block.unit_per_m *
                     ((1 - w) * ((1 - v) * dx00 + v * dx10) + w * ((1 - v) * dx01 + v * dx11));
    const float gy = block.unit_per_m * ((1 - w) * (c10 - c00) + w * (c11 - c01));
    const float gz = block.unit_per_m * (c1 - c0);
    values[0][i] = block.unit_m * (c0 + w * (c1 - c0));
    values[1][i] = gx * line.axial.x + gy * line.axial.y + gz * line.axial.z;
    values[2][i] = gx * line.lateral.x + gy * line.lateral.y + gz * line.lateral.z;
    values[3][i] = gx * line.elevation.x + gy * line.elevation.y + gz * line.elevation.z;
  }
}

WOBBLEBENCH_SIMD void trace_block(const TraceBlock& block,
                                  const TissueMap::Line& line,
                                  int count,
                                  TissueMap::LineNode* found) {
  NodePlaces places;
  NodePairs pairs{};
  float values[4][kTraceLanes];
  for (int first = 0; first < count; first += kTraceLanes) {
    const int used = std::min(kTraceLanes, count - first);
    place_lanes(block, line, first, places);
    gather_lanes(block, places, used, pairs);
    trace_lanes(pairs, places, line, block, values);
    for (int i = 0; i < used; ++i) {
      found[first + i] = {values[0][i], values[1][i], values[2][i], values[3][i]};
    }
  }
}

}  // namespace

void TissueMap::trace(const Entry& entry, const Line& line, int count, LineNode* found) const {
  const auto per_m = static_cast<float>(entry.divisions / cell_m_);
  trace_block({nodes(entry), entry.divisions, unit_m_, unit_m_ * per_m}, line, count, found);
}

}  // namespace wobblebench::sim
