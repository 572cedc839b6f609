// Construction of a TissueMap from a phantom's OpenVDB grids.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "sim/tissue/extended_distance.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

namespace {

using Grid = openvdb::FloatGrid;

/// Divisions of a cell that a surface crosses or nearly crosses; other cells within reach of it
/// have half as many. Larger cells are faster to traverse, but from the middle of a cell of six
/// steps its corners are farther than the level sets' narrow band: with a reach of 0, as for
/// `geometry`, cells of four steps avoid extending the distances.
constexpr int kFine = 6, kFineWithoutReach = 4;
/// Finer than any beam resolves.
constexpr double kFinestStep_m = 0.25e-3;
constexpr double kMaxCells = 1e8;

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
    const glm::dvec3 position{at.x(), at.y(), at.z()};
    box = {glm::min(box.low, position), glm::max(box.high, position)};
  }
  return box;
}

/// Bounding box and finest voxel of all surfaces; infinite where there are none.
struct Extent {
  double finest_voxel_m = std::numeric_limits<double>::infinity();
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high = -low;

  explicit Extent(const phantoms::Phantom& phantom) {
    for (const auto& grid : phantom.grids().signed_distance) {
      if (grid->empty()) continue;
      finest_voxel_m = std::min(finest_voxel_m, grid->voxelSize()[0]);
      const phantoms::Box box = bounds_of(*grid);
      low = glm::min(low, box.low);
      high = glm::max(high, box.high);
    }
  }
};

void check_counts(const phantoms::Phantom& phantom) {
  const std::size_t most = std::max(phantom.surfaces().size(), phantom.materials().size());
  if (most <= TissueMap::kMaxSurfaces) return;
  throw std::runtime_error(
      "phantom " + phantom.name() + ": has " + std::to_string(phantom.surfaces().size()) +
      " surfaces of " + std::to_string(phantom.materials().size()) +
      " materials; a scan takes at most " + std::to_string(TissueMap::kMaxSurfaces) + " of each");
}

}  // namespace

/// Fills a map's grid cell by cell. Node coordinates are in fine steps from the phantom's origin.
class TissueMapBuilder {
 public:
  /// The entries and nodes of one slab of cells.
  struct Slab {
    std::vector<TissueMap::Entry> entries;
    std::vector<TissueMap::NodeLine> nodes;

    std::span<const std::int16_t> nodes_of(const TissueMap::Entry& entry) const {
      return {nodes[entry.first_line].values.data(), node_count(entry.divisions)};
    }
  };

  static std::size_t node_count(int divisions) {
    const auto row = static_cast<std::size_t>(divisions) + 1;
    return row * row * row;
  }

  TissueMapBuilder(
      const phantoms::Phantom& phantom, double step_m, int fine, double reach_m, int threads)
      : phantom_(phantom), fine_(fine), cell_m_(fine * step_m), reach_m_(reach_m) {
    const auto& grids = phantom.grids().signed_distance;
    surfaces_.resize(grids.size());
    parallel_ranges(static_cast<int>(grids.size()), threads, [&](int first, int last) {
      for (int i = first; i < last; ++i) {
        const auto s = static_cast<std::size_t>(i);
        surfaces_[s] = ExtendedDistance(grids[s], step_m, reach_m + half_diagonal_m());
      }
    });
  }

  /// Unit of the nodes: their largest possible distance is the largest integer.
  float unit_m() const {
    return static_cast<float>((reach_m_ + 2 * half_diagonal_m()) /
                              std::numeric_limits<std::int16_t>::max());
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
      cell.base = static_cast<std::uint8_t>(builder_.phantom_.background());
      cell.first = static_cast<std::uint32_t>(slab.entries.size());
      for (std::size_t s = 0; s < readers_.size(); ++s) add_surface(s, low, cell, slab);
      cell.count = static_cast<std::uint8_t>(slab.entries.size() - cell.first);
      find_crossed(slab, cell);
      return cell;
    }

   private:
    /// Interpolated distances lie between those of the nodes.
    static void find_crossed(const Slab& slab, TissueMap::Cell& cell) {
      cell.material = cell.base;
      for (std::size_t e = cell.first; e < slab.entries.size(); ++e) {
        const TissueMap::Entry& entry = slab.entries[e];
        const auto [least, most] = std::ranges::minmax(slab.nodes_of(entry));
        cell.crossed |= least <= 0 && most >= 0;
        if (most < 0) cell.material = entry.inside;
      }
    }

    void add_surface(std::size_t s, const openvdb::Coord& low, TissueMap::Cell& cell, Slab& slab) {
      const auto inside = static_cast<std::uint8_t>(builder_.phantom_.surfaces()[s].inside);
      const double middle = static_cast<double>(readers_[s].at(low.offsetBy(builder_.fine_ / 2)));
      const double corner = builder_.half_diagonal_m();
      if (std::abs(middle) >= builder_.reach_m_ + corner) {
        if (middle > 0) return;
        // The cell lies inside this surface, which hides the entries before it.
        slab.entries.resize(cell.first);
        cell.base = inside;
        return;
      }
      const int fine = builder_.fine_;
      const bool close = std::abs(middle) < corner + builder_.cell_m_ / fine;
      const int divisions = close ? fine : fine / 2, stride = fine / divisions;
      const TissueMap::Entry entry{static_cast<std::uint32_t>(slab.nodes.size()),
                                   static_cast<std::uint8_t>(s),
                                   inside,
                                   static_cast<std::uint8_t>(divisions)};
      slab.entries.push_back(entry);
      constexpr std::size_t kLine = TissueMap::kLineNodes;
      slab.nodes.resize(slab.nodes.size() + (node_count(divisions) + kLine - 1) / kLine);
      std::int16_t* node = slab.nodes[entry.first_line].values.data();
      for (int z = 0; z <= fine; z += stride) {
        for (int y = 0; y <= fine; y += stride) {
          for (int x = 0; x <= fine; x += stride) {
            *node++ = builder_.in_units(readers_[s].at(low.offsetBy(x, y, z)));
          }
        }
      }
    }

    const TissueMapBuilder& builder_;
    std::vector<ExtendedDistance::Reader> readers_;
  };

 private:
  double half_diagonal_m() const { return std::sqrt(3.0) / 2 * cell_m_; }

  std::int16_t in_units(float distance_m) const {
    constexpr float kMost = std::numeric_limits<std::int16_t>::max();
    return static_cast<std::int16_t>(std::clamp(std::round(distance_m / unit_m()), -kMost, kMost));
  }

  const phantoms::Phantom& phantom_;
  int fine_;
  double cell_m_;
  double reach_m_;
  std::vector<ExtendedDistance> surfaces_;
};

TissueMap::TissueMap(const phantoms::Phantom& phantom, double reach_m, int threads)
    : reach_m_(reach_m) {
  check_counts(phantom);
  outside_.base = outside_.material = static_cast<std::uint8_t>(phantom.background());
  const Extent extent(phantom);
  if (!std::isfinite(extent.finest_voxel_m)) return;

  const int fine = reach_m > 0 ? kFine : kFineWithoutReach;
  step_m_ = std::max(extent.finest_voxel_m, kFinestStep_m);
  cell_m_ = fine * step_m_;
  const double margin = reach_m + cell_m_;
  origin_m_ = glm::floor((extent.low - margin) / cell_m_) * cell_m_;
  const glm::dvec3 span = glm::ceil((extent.high + margin - origin_m_) / cell_m_);
  if (span.x * span.y * span.z > kMaxCells) {
    throw std::runtime_error("phantom " + phantom.name() + ": too large for its voxels to scan");
  }
  cells_ = glm::ivec3(span);
  grid_.resize(static_cast<std::size_t>(cells_.x) * cells_.y * cells_.z);

  const openvdb::Coord origin = openvdb::Coord::round(to_vdb(origin_m_ / cell_m_));
  const TissueMapBuilder builder(phantom, step_m_, fine, reach_m, threads);
  unit_m_ = builder.unit_m();
  std::vector<TissueMapBuilder::Slab> slabs(static_cast<std::size_t>(cells_.z));
  parallel_ranges(cells_.z, threads, [&](int first, int last) {
    TissueMapBuilder::Worker worker(builder);
    for (int z = first; z < last; ++z) {
      std::size_t i = static_cast<std::size_t>(z) * cells_.y * cells_.x;
      for (int y = 0; y < cells_.y; ++y) {
        for (int x = 0; x < cells_.x; ++x) {
          const openvdb::Coord cell = origin.offsetBy(x, y, z);
          grid_[i++] =
              worker.cell(openvdb::Coord(cell.x() * fine, cell.y() * fine, cell.z() * fine),
                          slabs[static_cast<std::size_t>(z)]);
        }
      }
    }
  });
  for (std::size_t z = 0; z < slabs.size(); ++z) {
    const std::size_t layer = static_cast<std::size_t>(cells_.x) * cells_.y;
    for (std::size_t i = z * layer; i < (z + 1) * layer; ++i) {
      grid_[i].first += static_cast<std::uint32_t>(entries_.size());
    }
    for (Entry& entry : slabs[z].entries)
      entry.first_line += static_cast<std::uint32_t>(nodes_.size());
    entries_.insert(entries_.end(), slabs[z].entries.begin(), slabs[z].entries.end());
    nodes_.insert(nodes_.end(), slabs[z].nodes.begin(), slabs[z].nodes.end());
    slabs[z] = {};
  }
}

}  // namespace wobblebench::sim
