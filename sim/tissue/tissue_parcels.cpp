#include "sim/tissue/tissue_parcels.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "base/parallel.h"
#include "sim/beam/point_spread.h"
#include "sim/receive/losses.h"

namespace wobblebench::sim {

namespace {

constexpr double kNoEcho_db = -199;
constexpr int kCosines = 64;
/// Parcels: farther than any stick reaches.
constexpr int kEndless = 1 << 28;

/// Mean intensity of a Rayleigh envelope of mean 1.
const double kPowerOfMean = 4 / kPi;
glm::dvec3 cell_number(int cell, int divisions) {
  return {cell % divisions, cell / divisions % divisions, cell / (divisions * divisions)};
}

/// A cube at rest.
struct Cube {
  glm::dvec3 center_m{0};
  double side_m = 0;
};

/// The material of all of a cube and of what is within `margin_m` of its surfaces, if it is one.
std::optional<phantoms::MaterialIndex> one_material(const TissueMap& map,
                                                    const Cube& cube,
                                                    double margin_m) {
  // A cube may lie in several cells, each of which knows its own surfaces.
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

/// What a scatterer lies in.
struct Surroundings {
  phantoms::MaterialIndex material = 0;
  std::optional<SheetScatterer> sheet;
};

Surroundings surroundings(const TissueMap& map, const glm::dvec3& rest_m, float half_sheet_m) {
  const glm::ivec3 index = map.cell_at(rest_m);
  const glm::vec3 local((rest_m - map.origin_m()) / map.cell_m() - glm::dvec3(index));
  const TissueMap::Cell& cell = map.cell(index);
  Surroundings result{cell.base, {}};
  for (const TissueMap::Entry& entry : map.entries(cell)) {
    const float from_surface_m = map.value_m(entry, local);
    if (std::abs(from_surface_m) < half_sheet_m && entry.inside != result.material) {
      const glm::vec3 gradient = map.distance(entry, local).gradient;
      const float length = glm::length(gradient);
      const glm::vec3 outwards = length > 0 ? gradient / length : glm::vec3(0);
      result.sheet = SheetScatterer{0, entry.inside, result.material, outwards};
    } else if (from_surface_m < 0) {
      result.sheet.reset();  // painted over
    }
    if (from_surface_m < 0) result.material = entry.inside;
  }
  return result;
}

}  // namespace

TissueParcels::TissueParcels(const ScannedTissue& subject,
                             const hw::AcquisitionPlan& plan,
                             const SimulationOptions& options,
                             const ScattererCells& cells)
    : map_(subject.map),
      side_m_(cells.parcel_m),
      origin_m_(subject.map->origin_m()),
      parcels_(glm::ceil(glm::dvec3(map_->cells()) * map_->cell_m() / cells.parcel_m)),
      background_(map_->cell(glm::ivec3(-1)).base),
      processes_(&cells) {
  for (const auto& material : subject.materials) {
    const double mean =
        material.backscatter_db > kNoEcho_db ? amplitude_of_db(material.backscatter_db) : 0;
    power_.push_back(static_cast<float>(kPowerOfMean * mean * mean));
    amplitude_.push_back(std::sqrt(power_.back()));
  }
  if (options.interface_echo) {
    half_sheet_m_ = static_cast<float>(0.5 * std::sqrt(kPi) * sigma_of_fwhm(axial_fwhm_m(plan)));
    tabulate_sheets(subject.materials);
  }
  for (const Octave& octave : cells.octaves) {
    divisions_.push_back({octave.divisions, codes_per_parcel_});
    codes_per_parcel_ += octave.cells();
  }
  find_parcels(options.threads);
  known_ = std::vector<std::atomic<const ParcelCells*>>(mixed_.size());
}

TissueParcels::~TissueParcels() {
  for (const auto& cells : known_) delete cells.load();
}

void TissueParcels::tabulate_sheets(const std::vector<phantoms::Material>& materials) {
  for (const auto& before : materials) {
    for (const auto& behind : materials) {
      for (int i = 0; i <= kCosines; ++i) {
        // A stick passes a tilted sheet for longer, but hears the same energy.
        const double cosine = static_cast<double>(i) / kCosines;
        const double mean = diffuse_echo(before, behind, cosine);
        sheets_.push_back(static_cast<float>(kPowerOfMean * mean * mean * cosine));
      }
    }
  }
}

void TissueParcels::find_parcels(int threads) {
  const int layer = parcels_.x * parcels_.y;
  kinds_.resize(static_cast<std::size_t>(layer) * parcels_.z);
  const auto index = [&](int i) {
    return glm::ivec3(i % parcels_.x, i / parcels_.x % parcels_.y, i / layer);
  };
  const int count = static_cast<int>(kinds_.size());
  const auto margin_m = static_cast<double>(half_sheet_m_);
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

glm::ivec3 TissueParcels::first() const {
  return glm::ivec3(amplitude(background_) == 0 ? 0 : -kEndless);
}

glm::ivec3 TissueParcels::last() const {
  return amplitude(background_) == 0 ? parcels_ - 1 : glm::ivec3(kEndless);
}

TissueParcels::Parcel TissueParcels::parcel(const glm::ivec3& index) const {
  const bool within = index.x >= 0 && index.y >= 0 && index.z >= 0 && index.x < parcels_.x &&
                      index.y < parcels_.y && index.z < parcels_.z;
  if (!within) return {index, background_, nullptr};
  const std::int32_t kind =
      kinds_[(static_cast<std::size_t>(index.z) * parcels_.y + index.y) * parcels_.x + index.x];
  if (kind >= 0) return {index, kind, nullptr};
  return {index, 0, &cells_of(-1 - kind)};
}

/// Finds what one mixed parcel holds.
class CellMaker {
 public:
  CellMaker(const TissueParcels& parcels, const glm::ivec3& index)
      : parcels_(parcels),
        index_(index),
        corner_(parcels.origin_m_ + parcels.side_m_ * glm::dvec3(index)) {}

  std::unique_ptr<const ParcelCells> make(const ScattererCells& processes) {
    found_ = std::make_unique<ParcelCells>();
    found_->codes.reserve(static_cast<std::size_t>(parcels_.codes_per_parcel_));
    found_->kinds.reserve(static_cast<std::size_t>(parcels_.codes_per_parcel_));
    for (const Octave& octave : processes.octaves) {
      const double side_m = parcels_.side_m_ / octave.divisions;
      const std::uint32_t parcel_key = octave.parcel_key(index_);
      for (int i = 0; i < octave.cells(); ++i) {
        const glm::dvec3 low = corner_ + side_m * cell_number(i, octave.divisions);
        add(code(low, side_m, hash_cell_key(parcel_key, static_cast<std::uint32_t>(i))));
      }
    }
    // Flags are looked at many at a time, also behind the last octave's.
    found_->kinds.resize(found_->kinds.size() + kMostCells, CellKind::silent);
    return std::move(found_);
  }

 private:
  void add(int code) {
    const bool echoes = code < 0 || parcels_.amplitude(code) != 0;
    found_->codes.push_back(static_cast<std::int16_t>(code));
    found_->kinds.push_back(code < 0 ? CellKind::mixed
                                     : (echoes ? CellKind::even : CellKind::silent));
  }

  int code(const glm::dvec3& low, double side_m, std::uint32_t key) {
    const Cube cube{low + 0.5 * side_m, side_m};
    const auto margin_m = static_cast<double>(parcels_.half_sheet_m_);
    if (const auto material = one_material(*parcels_.map_, cube, margin_m)) return *material;
    Surroundings found[kScatterersInCell];
    bool alike = true;
    for (int i = 0; i < kScatterersInCell; ++i) {
      const glm::dvec3 place = scatterer_place(key, static_cast<std::uint32_t>(i));
      found[i] = surroundings(*parcels_.map_, low + side_m * place, parcels_.half_sheet_m_);
      alike &= found[i].material == found[0].material && !found[i].sheet;
    }
    return alike ? found[0].material : mixed(found);
  }

  int mixed(const Surroundings (&found)[kScatterersInCell]) {
    MixedCell cell;
    cell.first_sheet = static_cast<std::int32_t>(found_->sheets.size());
    for (int i = 0; i < kScatterersInCell; ++i) {
      cell.amplitude[i] = found[i].sheet ? 1 : parcels_.amplitude(found[i].material);
      if (!found[i].sheet) continue;
      cell.in_sheet |= 1u << i;
      found_->sheets.push_back(*found[i].sheet);
      found_->sheets.back().power = parcels_.power_[static_cast<std::size_t>(found[i].material)];
    }
    found_->cells.push_back(cell);
    return -static_cast<int>(found_->cells.size());
  }

  const TissueParcels& parcels_;
  glm::ivec3 index_;
  glm::dvec3 corner_;
  std::unique_ptr<ParcelCells> found_;
};

const ParcelCells& TissueParcels::cells_of(int mixed) const {
  auto& known = known_[static_cast<std::size_t>(mixed)];
  if (const ParcelCells* cells = known.load(std::memory_order_acquire)) return *cells;
  auto made = CellMaker(*this, mixed_[static_cast<std::size_t>(mixed)]).make(*processes_);
  // Another thread may have been faster; both found the same.
  const ParcelCells* others = nullptr;
  if (!known.compare_exchange_strong(others, made.get(), std::memory_order_acq_rel)) return *others;
  return *made.release();
}

float TissueParcels::sheet_power(const SheetScatterer& sheet, const glm::vec3& direction) const {
  const float along = glm::dot(sheet.outwards, direction);
  const auto before = static_cast<std::size_t>(along < 0 ? sheet.outside : sheet.inside);
  const auto behind = static_cast<std::size_t>(along < 0 ? sheet.inside : sheet.outside);
  const float place = std::min(std::abs(along), 1.0f) * kCosines;
  const int i = std::min(static_cast<int>(place), kCosines - 1);
  const float* value = sheets_.data() + (before * power_.size() + behind) * (kCosines + 1) + i;
  return value[0] + (place - static_cast<float>(i)) * (value[1] - value[0]);
}

float TissueParcels::sheet_amplitude(const ParcelCells& cells,
                                     const MixedCell& cell,
                                     int scatterer,
                                     const glm::vec3& direction) const {
  const int before = flags_set(cell.in_sheet & ((1u << scatterer) - 1));
  const SheetScatterer& sheet = cells.sheets[static_cast<std::size_t>(cell.first_sheet + before)];
  return std::sqrt(sheet.power + sheet_power(sheet, direction));
}

float TissueParcels::amplitude_at(
    const Parcel& parcel, int octave, int cell, int scatterer, const glm::vec3& direction) const {
  const int known = code(parcel, octave, cell);
  if (known >= 0) return amplitude(known);
  const MixedCell& mixed = mixed_cell(parcel, known);
  const bool in_sheet = (mixed.in_sheet >> scatterer & 1u) != 0;
  return in_sheet ? sheet_amplitude(*parcel.mixed, mixed, scatterer, direction)
                  : mixed.amplitude[scatterer];
}

}  // namespace wobblebench::sim
