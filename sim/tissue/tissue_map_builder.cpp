// Construction of a TissueMap from a phantom's OpenVDB grids.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "phantoms/float_grid.h"
#include "phantoms/grids.h"
#include "phantoms/phantom.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::sim {

namespace {

using Grid = phantoms::FloatGrid;

/// A level set, sampled by one thread at nodes: the integer multiples of a step. Nodes that are
/// voxel centres need no interpolation.
class GridReader {
 public:
  GridReader(const Grid& grid, double step_m);

  float at_node(const openvdb::Coord& node);
  /// Trilinear.
  float at(const openvdb::Vec3d& position_m);

 private:
  Grid::ConstAccessor accessor_;
  const Grid* grid_;
  double step_m_;
  int voxels_per_step_;  ///< 0: nodes are not voxel centres
  openvdb::Coord origin_;
};

/// The distances of one surface: the phantom's own narrow band, and beyond it a coarser level set
/// with distances up to the reach (first order, by fast sweeping). The nodes of the coarser one are
/// every second node.
class ExtendedDistance {
 public:
  ExtendedDistance() = default;
  ExtendedDistance(Grid::ConstPtr fine, double step_m, double reach_m);

  /// Access for one thread.
  class Reader {
   public:
    explicit Reader(const ExtendedDistance& source);
    /// Signed distance within the reach; beyond it only its sign is valid.
    float at(const openvdb::Coord& node);

   private:
    float trusted_m_;
    double step_m_;
    GridReader fine_;
    std::optional<GridReader> coarse_;
  };

 private:
  void extend(double reach_m);

  Grid::ConstPtr fine_;
  double step_m_ = 0;
  double band_m_ = 0;
  Grid::Ptr coarse_;
};

/// Fraction of the narrow band within which interpolation does not reach the constant background.
constexpr double kTrusted = 0.75;

/// Voxels per step if all nodes are voxel centres of the grid; else 0.
int voxels_per_step(const Grid& grid, double step_m) {
  const openvdb::Vec3d origin = grid.worldToIndex(openvdb::Vec3d(0));
  const openvdb::Vec3d diagonal = grid.worldToIndex(openvdb::Vec3d(step_m)) - origin;
  const openvdb::Vec3d along_x = grid.worldToIndex(openvdb::Vec3d(step_m, 0, 0)) - origin;
  const double ratio = std::round(diagonal.x());
  const openvdb::Vec3d whole(
      std::round(origin.x()), std::round(origin.y()), std::round(origin.z()));
  constexpr double kRounding = 1e-6;
  const bool fits = ratio >= 1 && (origin - whole).length() < kRounding &&
                    (diagonal - openvdb::Vec3d(ratio)).length() < kRounding &&
                    (along_x - openvdb::Vec3d(ratio, 0, 0)).length() < kRounding;
  return fits ? static_cast<int>(ratio) : 0;
}

openvdb::Coord scaled(const openvdb::Coord& c, int factor) {
  return {c.x() * factor, c.y() * factor, c.z() * factor};
}

openvdb::Vec3d gradient_at(Grid::ConstAccessor& tree, const openvdb::Coord& at, double voxel_m) {
  openvdb::Vec3d gradient;
  for (int axis = 0; axis < 3; ++axis) {
    openvdb::Coord low = at, high = at;
    low[axis] -= 1;
    high[axis] += 1;
    gradient[axis] = static_cast<double>(tree.getValue(high) - tree.getValue(low)) / (2 * voxel_m);
  }
  return gradient;
}

/// For a narrow band that ends within a step of the coarse grid: sets the distances of the nodes
/// around each voxel at the surface to those from the tangent plane of the nearest such voxel.
void add_tangent_distances(const Grid& fine, double coarse_m, Grid& coarse) {
  const Grid::Ptr nearest = phantoms::create_level_set(coarse_m, 1);  // squared distances, m^2
  auto target = coarse.getAccessor(), known = nearest->getAccessor();
  for (auto voxel = coarse.cbeginValueOn(); voxel; ++voxel) known.setValueOn(voxel.getCoord(), 0);
  auto source = fine.getConstAccessor();
  const double voxel_m = fine.voxelSize()[0];
  for (auto voxel = fine.cbeginValueOn(); voxel; ++voxel) {
    if (!voxel.isVoxelValue() || std::abs(static_cast<double>(*voxel)) > voxel_m) continue;
    const openvdb::Vec3d at = fine.indexToWorld(voxel.getCoord());
    const openvdb::Vec3d gradient = gradient_at(source, voxel.getCoord(), voxel_m);
    const openvdb::Coord low = openvdb::Coord::floor(at / coarse_m);
    for (int corner = 0; corner < 8; ++corner) {
      const openvdb::Coord node = low.offsetBy(corner & 1, corner >> 1 & 1, corner >> 2);
      const openvdb::Vec3d offset = node.asVec3d() * coarse_m - at;
      const auto distance2 = static_cast<float>(offset.lengthSqr());
      if (distance2 >= known.getValue(node)) continue;
      known.setValueOn(node, distance2);
      target.setValueOn(node,
                        static_cast<float>(static_cast<double>(*voxel) + gradient.dot(offset)));
    }
  }
}

bool is_multiple(const openvdb::Coord& c, int factor) {
  return c.x() % factor == 0 && c.y() % factor == 0 && c.z() % factor == 0;
}

GridReader::GridReader(const Grid& grid, double step_m)
    : accessor_(grid.getConstAccessor()),
      grid_(&grid),
      step_m_(step_m),
      voxels_per_step_(voxels_per_step(grid, step_m)),
      origin_(openvdb::Coord::round(grid.worldToIndex(openvdb::Vec3d(0)))) {}

float GridReader::at_node(const openvdb::Coord& node) {
  if (voxels_per_step_ == 0) return at(node.asVec3d() * step_m_);
  return accessor_.getValue(scaled(node, voxels_per_step_) + origin_);
}

float GridReader::at(const openvdb::Vec3d& position_m) {
  return openvdb::tools::BoxSampler::sample(accessor_, grid_->worldToIndex(position_m));
}

ExtendedDistance::ExtendedDistance(Grid::ConstPtr fine, double step_m, double reach_m)
    : fine_(std::move(fine)), step_m_(step_m), band_m_(static_cast<double>(fine_->background())) {
  if (!fine_->empty() && band_m_ < reach_m) extend(reach_m);
}

void ExtendedDistance::extend(double reach_m) {
  const double coarse_m = 2 * step_m_, voxel_m = fine_->voxelSize()[0];
  const bool thin = kTrusted * band_m_ < coarse_m;
  const Grid::Ptr coarse = phantoms::create_level_set(coarse_m, thin ? 2 * coarse_m : band_m_);
  GridReader source(*fine_, coarse_m);
  auto target = coarse->getAccessor();
  const int voxels = voxels_per_step(*fine_, coarse_m);
  const openvdb::Coord origin = openvdb::Coord::round(fine_->worldToIndex(openvdb::Vec3d(0)));
  for (auto voxel = fine_->cbeginValueOn(); voxel; ++voxel) {
    // Where nodes are voxel centres, other voxels are skipped: a node outside the band is not
    // trusted.
    if (voxels > 0 && !is_multiple(voxel.getCoord() - origin, voxels)) continue;
    const openvdb::Vec3d at = fine_->indexToWorld(voxel.getCoord());
    const openvdb::Coord node = openvdb::Coord::round(at / coarse_m);
    // A node is computed once, for the first voxel next to it.
    if ((at - node.asVec3d() * coarse_m).length() > voxel_m || target.isValueOn(node)) continue;
    const float value = source.at_node(node);
    if (std::abs(static_cast<double>(value)) < kTrusted * band_m_) target.setValueOn(node, value);
  }
  if (thin) add_tangent_distances(*fine_, coarse_m, *coarse);
  openvdb::tools::signedFloodFill(coarse->tree());
  if (!phantoms::has_both_sides(*coarse)) {  // a body between the nodes
    const int fine_layers = static_cast<int>(std::ceil((reach_m - band_m_) / voxel_m)) + 1;
    coarse_ = phantoms::widen_band(*fine_, fine_layers, phantoms::Neighbours::faces);
    return;
  }
  const int layers = static_cast<int>(std::ceil((reach_m - kTrusted * band_m_) / coarse_m)) + 1;
  // Over faces alone a band grows by less than a voxel per layer along diagonals; a thin band has
  // no voxels to spare for that.
  coarse_ = phantoms::widen_band(
      *coarse, layers, thin ? phantoms::Neighbours::faces_and_edges : phantoms::Neighbours::faces);
}

ExtendedDistance::Reader::Reader(const ExtendedDistance& source)
    : trusted_m_(static_cast<float>(kTrusted * source.band_m_)),
      step_m_(source.step_m_),
      fine_(*source.fine_, source.step_m_) {
  if (source.coarse_) coarse_.emplace(*source.coarse_, 2 * source.step_m_);
}

float ExtendedDistance::Reader::at(const openvdb::Coord& node) {
  const float near = fine_.at_node(node);
  if (!coarse_ || std::abs(near) < trusted_m_) return near;
  const bool shared = ((node.x() | node.y() | node.z()) & 1) == 0;
  if (!shared) return coarse_->at(node.asVec3d() * step_m_);
  return coarse_->at_node({node.x() / 2, node.y() / 2, node.z() / 2});
}

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
