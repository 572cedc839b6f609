#include "sim/speckle/scatterers/tissue_blocks.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "base/parallel.h"
#include "base/units.h"
#include "sim/losses/losses.h"
#include "sim/optics/probe_optics.h"
#include "sim/options.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

namespace {

constexpr double kNoEcho_db = -199;
constexpr int kCosines = 64;
/// Block index beyond the reach of any stick.
constexpr int kUnbounded = 1 << 28;

/// A cube at rest.
struct Cube {
  glm::dvec3 center_m{0};
  double side_m = 0;
};

/// The material of a cube, if it is the only one within `margin_m` of the cube.
std::optional<phantoms::MaterialIndex> one_material(const TissueMap& map,
                                                    const Cube& cube,
                                                    double margin_m) {
  // A cube may overlap several cells of the map, each with surfaces of its own.
  const double half_m = 0.5 * cube.side_m;
  const glm::ivec3 first = map.cell_at(cube.center_m - half_m * (1 - 1e-6));
  const glm::ivec3 last = map.cell_at(cube.center_m + half_m * (1 - 1e-6));
  std::optional<phantoms::MaterialIndex> material;
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      for (int x = first.x; x <= last.x; ++x) {
        const glm::ivec3 index(x, y, z);
        const glm::dvec3 corner = map.origin_m() + map.cell_m() * glm::dvec3(index);
        const glm::dvec3 low = glm::max(cube.center_m - half_m, corner);
        const glm::dvec3 high = glm::min(cube.center_m + half_m, corner + map.cell_m());
        const TissueMap::Cell& cell = map.cell(index);
        const glm::vec3 local((0.5 * (low + high) - corner) / map.cell_m());
        const double reach_m = 0.5 * glm::length(high - low) + margin_m;
        phantoms::MaterialIndex here = cell.base;
        for (const TissueMap::Entry& entry : map.entries(cell)) {
          const auto distance = static_cast<double>(map.value_m(entry, local));
          if (std::abs(distance) <= reach_m) return {};
          if (distance < 0) here = entry.inside;
        }
        if (material && *material != here) return {};
        material = here;
      }
    }
  }
  return material;
}

/// The tissue at a scatterer.
struct Surroundings {
  phantoms::MaterialIndex material = 0;
  std::optional<InterfaceScatterer> interface;
};

Surroundings surroundings(const TissueMap& map, const glm::dvec3& rest_m, float half_layer_m) {
  const glm::ivec3 index = map.cell_at(rest_m);
  const glm::vec3 local((rest_m - map.origin_m()) / map.cell_m() - glm::dvec3(index));
  const TissueMap::Cell& cell = map.cell(index);
  Surroundings result{cell.base, {}};
  for (const TissueMap::Entry& entry : map.entries(cell)) {
    const float from_surface_m = map.value_m(entry, local);
    if (std::abs(from_surface_m) < half_layer_m && entry.inside != result.material) {
      const glm::vec3 gradient = map.distance(entry, local).gradient;
      const float length = glm::length(gradient);
      const glm::vec3 outwards = length > 0 ? gradient / length : glm::vec3(0);
      result.interface = InterfaceScatterer{0, entry.inside, result.material, outwards};
    } else if (from_surface_m < 0) {
      result.interface.reset();  // hidden by this surface
    }
    if (from_surface_m < 0) result.material = entry.inside;
  }
  return result;
}

}  // namespace

TissueBlocks::TissueBlocks(const ScannedTissue& tissue,
                           const ProbeOptics& optics,
                           const SimulationOptions& options,
                           const ScattererCells& cells)
    : map_(tissue.map),
      side_m_(cells.block_m),
      origin_m_(tissue.map->origin_m()),
      blocks_(glm::ceil(glm::dvec3(map_->cells()) * map_->cell_m() / cells.block_m)),
      background_(map_->cell(glm::ivec3(-1)).base),
      scatterer_cells_(&cells) {
  for (const auto& material : tissue.materials) {
    const double mean =
        material.backscatter_db > kNoEcho_db ? amplitude_of_db(material.backscatter_db) : 0;
    power_.push_back(static_cast<float>(kPowerOfRayleighMean * mean * mean));
    amplitude_.push_back(std::sqrt(power_.back()));
  }
  if (options.interface_echo) {
    half_layer_m_ = static_cast<float>(0.5 * std::sqrt(kPi) * optics.band().sigma_m());
    tabulate_interfaces(tissue.materials);
  }
  for (const Octave& octave : cells.octaves) {
    first_cell_.push_back(codes_per_block_);
    codes_per_block_ += octave.cells();
  }
  classify_blocks(options.threads);
  mixed_cells_ = std::vector<std::atomic<const BlockCells*>>(mixed_.size());
}

TissueBlocks::~TissueBlocks() {
  for (const auto& cells : mixed_cells_) delete cells.load();
}

void TissueBlocks::tabulate_interfaces(const std::vector<phantoms::Material>& materials) {
  for (const auto& before : materials) {
    for (const auto& behind : materials) {
      for (int i = 0; i <= kCosines; ++i) {
        // A stick's path through a tilted layer is longer, for the same energy.
        const double cosine = static_cast<double>(i) / kCosines;
        const double mean = diffuse_echo(before, behind, cosine);
        interface_power_.push_back(static_cast<float>(kPowerOfRayleighMean * mean * mean * cosine));
      }
    }
  }
}

void TissueBlocks::classify_blocks(int threads) {
  const int layer = blocks_.x * blocks_.y;
  kinds_.resize(static_cast<std::size_t>(layer) * blocks_.z);
  const auto index = [&](int i) {
    return glm::ivec3(i % blocks_.x, i / blocks_.x % blocks_.y, i / layer);
  };
  const int count = static_cast<int>(kinds_.size());
  const auto margin_m = static_cast<double>(half_layer_m_);
  parallel_ranges(count, threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      const Cube cube{origin_m_ + side_m_ * (glm::dvec3(index(i)) + 0.5), side_m_};
      kinds_[static_cast<std::size_t>(i)] = one_material(*map_, cube, margin_m).value_or(-1);
    }
  });
  for (int i = 0; i < count; ++i) {
    if (kinds_[static_cast<std::size_t>(i)] >= 0) continue;
    mixed_.push_back(index(i));
    kinds_[static_cast<std::size_t>(i)] = -static_cast<std::int32_t>(mixed_.size());
  }
}

glm::ivec3 TissueBlocks::first() const {
  return glm::ivec3(amplitude(background_) == 0 ? 0 : -kUnbounded);
}

glm::ivec3 TissueBlocks::last() const {
  return amplitude(background_) == 0 ? blocks_ - 1 : glm::ivec3(kUnbounded);
}

TissueBlocks::Block TissueBlocks::block(const glm::ivec3& index) const {
  const bool within = index.x >= 0 && index.y >= 0 && index.z >= 0 && index.x < blocks_.x &&
                      index.y < blocks_.y && index.z < blocks_.z;
  if (!within) return {index, background_, nullptr};
  const std::int32_t kind =
      kinds_[(static_cast<std::size_t>(index.z) * blocks_.y + index.y) * blocks_.x + index.x];
  if (kind >= 0) return {index, kind, nullptr};
  return {index, 0, &cells_of(-1 - kind)};
}

/// Determines the hash cells of one mixed block.
class BlockCellsBuilder {
 public:
  BlockCellsBuilder(const TissueBlocks& blocks, const glm::ivec3& index)
      : blocks_(blocks),
        index_(index),
        corner_(blocks.origin_m_ + blocks.side_m_ * glm::dvec3(index)) {}

  std::unique_ptr<const BlockCells> make(const ScattererCells& scatterer_cells) {
    found_ = std::make_unique<BlockCells>();
    found_->codes.reserve(static_cast<std::size_t>(blocks_.codes_per_block_));
    found_->kinds.reserve(static_cast<std::size_t>(blocks_.codes_per_block_));
    for (const Octave& octave : scatterer_cells.octaves) {
      const double side_m = blocks_.side_m_ / octave.divisions;
      const std::uint32_t block_key = octave.block_key(index_);
      for (int i = 0; i < octave.cells(); ++i) {
        const glm::dvec3 low = corner_ + side_m * cell_coordinates(i, octave.divisions);
        add(code(low, side_m, hash_cell_key(block_key, static_cast<std::uint32_t>(i))));
      }
    }
    // Flags are read in vectors, also past those of the last octave.
    found_->kinds.resize(found_->kinds.size() + kMaxCells, CellKind::anechoic);
    return std::move(found_);
  }

 private:
  void add(int code) {
    const bool echoes = code < 0 || blocks_.amplitude(code) != 0;
    found_->codes.push_back(static_cast<std::int16_t>(code));
    found_->kinds.push_back(code < 0 ? CellKind::mixed
                                     : (echoes ? CellKind::homogeneous : CellKind::anechoic));
  }

  int code(const glm::dvec3& low, double side_m, std::uint32_t key) {
    const Cube cube{low + 0.5 * side_m, side_m};
    const auto margin_m = static_cast<double>(blocks_.half_layer_m_);
    if (const auto material = one_material(*blocks_.map_, cube, margin_m)) return *material;
    Surroundings found[kScatterersInCell];
    bool all_equal = true;
    for (int i = 0; i < kScatterersInCell; ++i) {
      const glm::dvec3 position = scatterer_position(key, static_cast<std::uint32_t>(i));
      found[i] = surroundings(*blocks_.map_, low + side_m * position, blocks_.half_layer_m_);
      all_equal &= found[i].material == found[0].material && !found[i].interface;
    }
    return all_equal ? found[0].material : mixed(found);
  }

  int mixed(const Surroundings (&found)[kScatterersInCell]) {
    MixedCell cell;
    cell.first_interface = static_cast<std::int32_t>(found_->interfaces.size());
    for (int i = 0; i < kScatterersInCell; ++i) {
      cell.amplitude[i] = found[i].interface ? 1 : blocks_.amplitude(found[i].material);
      if (!found[i].interface) continue;
      cell.near_interface |= 1u << i;
      found_->interfaces.push_back(*found[i].interface);
      found_->interfaces.back().power = blocks_.power_[static_cast<std::size_t>(found[i].material)];
    }
    found_->cells.push_back(cell);
    return -static_cast<int>(found_->cells.size());
  }

  const TissueBlocks& blocks_;
  glm::ivec3 index_;
  glm::dvec3 corner_;
  std::unique_ptr<BlockCells> found_;
};

const BlockCells& TissueBlocks::cells_of(int mixed) const {
  auto& shared = mixed_cells_[static_cast<std::size_t>(mixed)];
  if (const BlockCells* cells = shared.load(std::memory_order_acquire)) return *cells;
  auto made =
      BlockCellsBuilder(*this, mixed_[static_cast<std::size_t>(mixed)]).make(*scatterer_cells_);
  // Another thread may have been faster; both results are equal.
  const BlockCells* others = nullptr;
  if (!shared.compare_exchange_strong(others, made.get(), std::memory_order_acq_rel))
    return *others;
  return *made.release();
}

float TissueBlocks::interface_power(const CrossedInterface& crossed, float cosine) const {
  const auto before = static_cast<std::size_t>(crossed.before);
  const auto behind = static_cast<std::size_t>(crossed.behind);
  const float position = std::min(std::abs(cosine), 1.0f) * kCosines;
  const int i = std::min(static_cast<int>(position), kCosines - 1);
  const float* value =
      interface_power_.data() + (before * power_.size() + behind) * (kCosines + 1) + i;
  return value[0] + (position - static_cast<float>(i)) * (value[1] - value[0]);
}

ScattererEcho TissueBlocks::interface_echo(const BlockCells& cells,
                                           const MixedCell& cell,
                                           int scatterer,
                                           const glm::vec3& direction) const {
  const int before = popcount16(cell.near_interface & ((1u << scatterer) - 1));
  const InterfaceScatterer& found =
      cells.interfaces[static_cast<std::size_t>(cell.first_interface + before)];
  const float along = glm::dot(found.outwards, direction);
  const CrossedInterface crossed = along < 0 ? CrossedInterface{found.outside, found.inside}
                                             : CrossedInterface{found.inside, found.outside};
  return {std::sqrt(found.power + interface_power(crossed, along)), crossed};
}

ScattererEcho TissueBlocks::echo_at(
    const Block& block, int octave, int cell, int scatterer, const glm::vec3& direction) const {
  const int found = code(block, octave, cell);
  if (found >= 0) return {amplitude(found)};
  const MixedCell& mixed = mixed_cell(block, found);
  const bool near_interface = (mixed.near_interface >> scatterer & 1u) != 0;
  return near_interface ? interface_echo(*block.mixed, mixed, scatterer, direction)
                        : ScattererEcho{mixed.amplitude[scatterer]};
}

}  // namespace wobblebench::sim
