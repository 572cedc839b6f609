#include "sim/tissue_map.h"

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <utility>

#include "phantoms/grids.h"
#include "sim/parallel.h"
#include "sim/simd.h"
#include "sim/wide_distance.h"

namespace wobblebench::sim {

namespace {

using Grid = openvdb::FloatGrid;

constexpr int kFine = 4;    // divisions of a cell that a surface passes through or nearly so
constexpr int kCoarse = 2;  // of a cell that is only within its reach
/// Finer than any beam resolves; finer lattices only cost memory.
constexpr double kFinestStep_m = 0.25e-3;
constexpr double kMostCells = 1e8;

openvdb::Vec3d to_vdb(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

phantoms::Box bounds_of(const Grid& grid) {
  const openvdb::CoordBBox active = grid.evalActiveVoxelBoundingBox();
  phantoms::Box box{glm::dvec3(std::numeric_limits<double>::infinity()),
                    glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Vec3d at =
        grid.indexToWorld(openvdb::Coord(corner & 1 ? active.max().x() : active.min().x(),
                                         corner & 2 ? active.max().y() : active.min().y(),
                                         corner & 4 ? active.max().z() : active.min().z()));
    const glm::dvec3 place{at.x(), at.y(), at.z()};
    box = {glm::min(box.low, place), glm::max(box.high, place)};
  }
  return box;
}

/// The entries and nodes of one slab of cells.
struct Slab {
  std::vector<TissueMap::Entry> entries;
  std::vector<float> nodes;
};

}  // namespace

/// Fills a map's lattice cell by cell. Nodes are counted in fine steps from the phantom's origin.
class TissueMapBuilder {
 public:
  TissueMapBuilder(const phantoms::Phantom& phantom, double cell_m, double reach_m, int threads)
      : phantom_(phantom), cell_m_(cell_m), reach_m_(reach_m) {
    const auto& grids = phantom.grids().signed_distance;
    surfaces_.resize(grids.size());
    parallel_ranges(static_cast<int>(grids.size()), threads, [&](int first, int last) {
      for (int i = first; i < last; ++i) {
        const auto s = static_cast<std::size_t>(i);
        surfaces_[s] = WideDistance(grids[s], cell_m / kFine, reach_m + half_diagonal_m());
      }
    });
  }

  /// Fills cells for one thread.
  class Worker {
   public:
    explicit Worker(const TissueMapBuilder& builder) : builder_(builder) {
      for (const auto& surface : builder.surfaces_) readers_.emplace_back(surface);
    }

    /// `low`: node at the cell's low corner.
    TissueMap::Cell cell(const openvdb::Coord& low, Slab& slab) {
      TissueMap::Cell cell;
      cell.base = builder_.phantom_.background();
      cell.first = static_cast<std::uint32_t>(slab.entries.size());
      for (std::size_t s = 0; s < readers_.size(); ++s) add_surface(s, low, cell, slab);
      cell.count = static_cast<std::uint32_t>(slab.entries.size()) - cell.first;
      find_crossed(slab, cell);
      return cell;
    }

   private:
    /// What lies between nodes is between their values.
    static void find_crossed(const Slab& slab, TissueMap::Cell& cell) {
      cell.material = cell.base;
      for (std::size_t e = cell.first; e < slab.entries.size(); ++e) {
        const TissueMap::Entry& entry = slab.entries[e];
        const auto begin = slab.nodes.begin() + static_cast<std::ptrdiff_t>(entry.block);
        const std::ptrdiff_t row = entry.divisions + 1;
        const auto [least, most] = std::minmax_element(begin, begin + row * row * row);
        cell.crossed |= *least <= 0 && *most >= 0;
        if (*most < 0) cell.material = entry.inside;
      }
    }

    void add_surface(std::size_t s, const openvdb::Coord& low, TissueMap::Cell& cell, Slab& slab) {
      const auto inside = builder_.phantom_.surfaces()[s].inside;
      const double middle = static_cast<double>(readers_[s].at(low.offsetBy(kFine / 2)));
      const double corner = builder_.half_diagonal_m();
      if (std::abs(middle) >= builder_.reach_m_ + corner) {
        if (middle > 0) return;
        // What was painted before is hidden here.
        slab.entries.resize(cell.first);
        cell.base = inside;
        return;
      }
      const bool close = std::abs(middle) < corner + builder_.cell_m_ / kFine;
      const int divisions = close ? kFine : kCoarse, stride = kFine / divisions;
      slab.entries.push_back({static_cast<std::int32_t>(s),
                              inside,
                              static_cast<std::uint32_t>(slab.nodes.size()),
                              divisions});
      for (int z = 0; z <= kFine; z += stride) {
        for (int y = 0; y <= kFine; y += stride) {
          for (int x = 0; x <= kFine; x += stride) {
            slab.nodes.push_back(readers_[s].at(low.offsetBy(x, y, z)));
          }
        }
      }
    }

    const TissueMapBuilder& builder_;
    std::vector<WideDistance::Reader> readers_;
  };

 private:
  double half_diagonal_m() const { return std::sqrt(3.0) / 2 * cell_m_; }

  const phantoms::Phantom& phantom_;
  double cell_m_;
  double reach_m_;
  std::vector<WideDistance> surfaces_;
};

TissueMap::TissueMap(const phantoms::Phantom& phantom, double reach_m, int threads)
    : reach_m_(reach_m) {
  outside_.base = outside_.material = phantom.background();
  double finest = std::numeric_limits<double>::infinity();
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const auto& grid : phantom.grids().signed_distance) {
    if (grid->empty()) continue;
    finest = std::min(finest, grid->voxelSize()[0]);
    const phantoms::Box box = bounds_of(*grid);
    low = glm::min(low, box.low);
    high = glm::max(high, box.high);
  }
  if (!std::isfinite(finest)) return;

  cell_m_ = kFine * std::max(finest, kFinestStep_m);
  const double margin = reach_m + cell_m_;
  origin_m_ = glm::floor((low - margin) / cell_m_) * cell_m_;
  const glm::dvec3 span = glm::ceil((high + margin - origin_m_) / cell_m_);
  if (span.x * span.y * span.z > kMostCells) {
    throw std::runtime_error("phantom " + phantom.name() + ": too large for its voxels to scan");
  }
  cells_ = glm::ivec3(span);
  lattice_.resize(static_cast<std::size_t>(cells_.x) * cells_.y * cells_.z);

  const openvdb::Coord origin = openvdb::Coord::round(to_vdb(origin_m_ / cell_m_));
  const TissueMapBuilder builder(phantom, cell_m_, reach_m, threads);
  std::vector<Slab> slabs(static_cast<std::size_t>(cells_.z));
  parallel_ranges(cells_.z, threads, [&](int first, int last) {
    TissueMapBuilder::Worker worker(builder);
    for (int z = first; z < last; ++z) {
      std::size_t i = static_cast<std::size_t>(z) * cells_.y * cells_.x;
      for (int y = 0; y < cells_.y; ++y) {
        for (int x = 0; x < cells_.x; ++x) {
          const openvdb::Coord cell = origin.offsetBy(x, y, z);
          lattice_[i++] =
              worker.cell(openvdb::Coord(cell.x() * kFine, cell.y() * kFine, cell.z() * kFine),
                          slabs[static_cast<std::size_t>(z)]);
        }
      }
    }
  });
  for (std::size_t z = 0; z < slabs.size(); ++z) {
    const std::size_t layer = static_cast<std::size_t>(cells_.x) * cells_.y;
    for (std::size_t i = z * layer; i < (z + 1) * layer; ++i) {
      lattice_[i].first += static_cast<std::uint32_t>(entries_.size());
    }
    for (Entry& entry : slabs[z].entries) entry.block += static_cast<std::uint32_t>(nodes_.size());
    entries_.insert(entries_.end(), slabs[z].entries.begin(), slabs[z].entries.end());
    nodes_.insert(nodes_.end(), slabs[z].nodes.begin(), slabs[z].nodes.end());
    slabs[z] = {};
  }
}

glm::ivec3 TissueMap::cell_at(const glm::dvec3& rest_m) const {
  return glm::ivec3(glm::floor((rest_m - origin_m_) / cell_m_));
}

const TissueMap::Cell& TissueMap::cell(const glm::ivec3& index) const {
  const bool within = index.x >= 0 && index.y >= 0 && index.z >= 0 && index.x < cells_.x &&
                      index.y < cells_.y && index.z < cells_.z;
  if (!within) return outside_;
  return lattice_[(static_cast<std::size_t>(index.z) * cells_.y + index.y) * cells_.x + index.x];
}

TissueMap::Distance TissueMap::distance(const Entry& entry, const glm::vec3& local) const {
  const int n = entry.divisions;
  const glm::vec3 place = local * static_cast<float>(n);
  const int x = std::clamp(static_cast<int>(place.x), 0, n - 1);
  const int y = std::clamp(static_cast<int>(place.y), 0, n - 1);
  const int z = std::clamp(static_cast<int>(place.z), 0, n - 1);
  const float u = place.x - static_cast<float>(x);
  const float v = place.y - static_cast<float>(y);
  const float w = place.z - static_cast<float>(z);
  const std::size_t row = static_cast<std::size_t>(n) + 1;
  const float* corner =
      nodes_.data() + entry.block + (static_cast<std::size_t>(z) * row + y) * row + x;
  const float* above = corner + row * row;
  // Along x on the four edges, then along y on both faces, then along z.
  const float dx00 = corner[1] - corner[0], dx10 = corner[row + 1] - corner[row];
  const float dx01 = above[1] - above[0], dx11 = above[row + 1] - above[row];
  const float c00 = corner[0] + u * dx00, c10 = corner[row] + u * dx10;
  const float c01 = above[0] + u * dx01, c11 = above[row] + u * dx11;
  const float c0 = c00 + v * (c10 - c00), c1 = c01 + v * (c11 - c01);
  const float per_m = static_cast<float>(n / cell_m_);
  const float gx = (1 - w) * ((1 - v) * dx00 + v * dx10) + w * ((1 - v) * dx01 + v * dx11);
  const float gy = (1 - w) * (c10 - c00) + w * (c11 - c01);
  return {c0 + w * (c1 - c0), per_m * glm::vec3(gx, gy, c1 - c0)};
}

namespace {

struct TraceBlock {
  const float* nodes;
  std::int32_t divisions;
  float per_m;
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
  struct Edge {
    float low;
    float high;
  };
  Edge edges[4][kTraceLanes];
};

void gather_lanes(const TraceBlock& block, const NodePlaces& places, int count, NodePairs& pairs) {
  const std::ptrdiff_t row = block.divisions + 1, layer = row * row;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const float* node = block.nodes + places.at[i];
    pairs.edges[0][i] = {node[0], node[1]};
    pairs.edges[1][i] = {node[row], node[row + 1]};
    pairs.edges[2][i] = {node[layer], node[layer + 1]};
    pairs.edges[3][i] = {node[layer + row], node[layer + row + 1]};
  }
}

/// trace() for a block of places.
WOBBLEBENCH_INLINE void trace_lanes(const NodePairs& pairs,
                                    const NodePlaces& places,
                                    const TissueMap::Line& line,
                                    float per_m,
                                    float (&values)[4][kTraceLanes]) {
  for (int i = 0; i < kTraceLanes; ++i) {
    const float u = places.u[i], v = places.v[i], w = places.w[i];
    const float a000 = pairs.edges[0][i].low, a010 = pairs.edges[1][i].low;
    const float a001 = pairs.edges[2][i].low, a011 = pairs.edges[3][i].low;
    // Along x on the four edges, then along y on both faces, then along z.
    const float dx00 = pairs.edges[0][i].high - a000, dx10 = pairs.edges[1][i].high - a010;
    const float dx01 = pairs.edges[2][i].high - a001, dx11 = pairs.edges[3][i].high - a011;
    const float c00 = a000 + u * dx00, c10 = a010 + u * dx10;
    const float c01 = a001 + u * dx01, c11 = a011 + u * dx11;
    const float c0 = c00 + v * (c10 - c00), c1 = c01 + v * (c11 - c01);
    const float gx =
        per_m * ((1 - w) * ((1 - v) * dx00 + v * dx10) + w * ((1 - v) * dx01 + v * dx11));
    const float gy = per_m * ((1 - w) * (c10 - c00) + w * (c11 - c01));
    const float gz = per_m * (c1 - c0);
    values[0][i] = c0 + w * (c1 - c0);
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
    trace_lanes(pairs, places, line, block.per_m, values);
    for (int i = 0; i < used; ++i) {
      found[first + i] = {values[0][i], values[1][i], values[2][i], values[3][i]};
    }
  }
}

}  // namespace

void TissueMap::trace(const Entry& entry, const Line& line, int count, LineNode* found) const {
  const auto per_m = static_cast<float>(entry.divisions / cell_m_);
  trace_block({nodes_.data() + entry.block, entry.divisions, per_m}, line, count, found);
}

phantoms::MaterialIndex TissueMap::material(const glm::dvec3& rest_m) const {
  const glm::ivec3 index = cell_at(rest_m);
  const Cell& found = cell(index);
  const glm::vec3 local((rest_m - origin_m_) / cell_m_ - glm::dvec3(index));
  phantoms::MaterialIndex result = found.base;
  for (const Entry& entry : entries(found)) {
    if (distance(entry, local).value_m < 0) result = entry.inside;
  }
  return result;
}

glm::dvec3 TissueMap::normal(std::int32_t surface, const glm::dvec3& rest_m) const {
  const double step_m = cell_m_ / kFine;
  const auto distance_at = [&](const glm::dvec3& place) -> double {
    const glm::ivec3 index = cell_at(place);
    const glm::vec3 local((place - origin_m_) / cell_m_ - glm::dvec3(index));
    for (const Entry& entry : entries(cell(index))) {
      if (entry.surface == surface) return static_cast<double>(distance(entry, local).value_m);
    }
    return 0;
  };
  glm::dvec3 rise(0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 step(0);
    step[axis] = step_m;
    rise[axis] = distance_at(rest_m + step) - distance_at(rest_m - step);
  }
  const double length = glm::length(rise);
  return length > 0 ? rise / length : glm::dvec3(0);
}

std::size_t TissueMap::bytes() const {
  return lattice_.size() * sizeof(Cell) + entries_.size() * sizeof(Entry) +
         nodes_.size() * sizeof(float);
}

}  // namespace wobblebench::sim
