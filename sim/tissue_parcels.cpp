#include "sim/tissue_parcels.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "sim/losses.h"
#include "sim/parallel.h"
#include "sim/point_spread.h"
#include "sim/surface_patches.h"

namespace wobblebench::sim {

namespace {

constexpr double kNoEcho_db = -199;
constexpr int kCosines = 64;

/// Mean intensity of a Rayleigh envelope of mean 1.
const double kPowerOfMean = 4 / kPi;
/// A pulse in the middle of a sheet as thick as sigma sqrt(pi), its effective length, finds this
/// much of its own power in it.
const double kShareInSheet = std::erf(std::sqrt(kPi) / 2);

glm::dvec3 cell_number(int cell, int divisions) {
  return {cell % divisions, cell / divisions % divisions, cell / (divisions * divisions)};
}

/// From -1 to 1 across the hash cell.
glm::vec3 place_in_cell(const CellOffset& offset) {
  return glm::vec3(offset.x * static_cast<float>(2 / kHashUnits[0]),
                   offset.y * static_cast<float>(2 / kHashUnits[1]),
                   offset.z * static_cast<float>(2 / kHashUnits[2])) -
         1.0f;
}

float distance(const SurfacePatch& p, const glm::vec3& r) {
  return p.at + r.x * (p.bx + p.qxx * r.x + p.qxy * r.y) +
         r.y * (p.by + p.qyy * r.y + p.qyz * r.z) + r.z * (p.bz + p.qzz * r.z + p.qxz * r.x);
}

glm::vec3 gradient(const SurfacePatch& p, const glm::vec3& r) {
  return {p.bx + 2 * p.qxx * r.x + p.qxy * r.y + p.qxz * r.z,
          p.by + 2 * p.qyy * r.y + p.qxy * r.x + p.qyz * r.z,
          p.bz + 2 * p.qzz * r.z + p.qyz * r.y + p.qxz * r.x};
}

}  // namespace

TissueParcels::TissueParcels(const Subject& subject,
                             const hw::AcquisitionPlan& plan,
                             const SimulationOptions& options,
                             const ScattererCells& cells)
    : map_(subject.map),
      side_m_(cells.parcel_m),
      origin_m_(subject.map->origin_m()),
      parcels_(glm::ceil(glm::dvec3(map_->cells()) * map_->cell_m() / cells.parcel_m)),
      background_(map_->cell(glm::ivec3(-1)).base) {
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
    divisions_.push_back({octave.divisions, static_cast<int>(codes_per_parcel_)});
    codes_per_parcel_ += static_cast<std::size_t>(octave.cells());
  }
  find_parcels(options.threads);
  find_codes(options.threads);
}

void TissueParcels::tabulate_sheets(const std::vector<phantoms::Material>& materials) {
  for (const auto& before : materials) {
    for (const auto& behind : materials) {
      for (int i = 0; i <= kCosines; ++i) {
        const double mean = diffuse_echo(before, behind, static_cast<double>(i) / kCosines);
        sheets_.push_back(static_cast<float>(kPowerOfMean * mean * mean / kShareInSheet));
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

TissueParcels::Parcel TissueParcels::parcel(const glm::ivec3& index) const {
  const bool within = index.x >= 0 && index.y >= 0 && index.z >= 0 && index.x < parcels_.x &&
                      index.y < parcels_.y && index.z < parcels_.z;
  if (!within) return {index, background_, -1};
  const std::int32_t kind =
      kinds_[(static_cast<std::size_t>(index.z) * parcels_.y + index.y) * parcels_.x + index.x];
  return kind >= 0 ? Parcel{index, kind, -1} : Parcel{index, 0, -1 - kind};
}

/// Finds the codes of mixed parcels, each with patches of its own.
class PatchMaker {
 public:
  explicit PatchMaker(const TissueParcels& parcels) : parcels_(parcels) {}

  /// Codes that name patches count from this parcel's first one.
  void make(int number, std::int32_t* codes, std::vector<SurfacePatch>& patches) const {
    const glm::dvec3 corner =
        parcels_.origin_m_ +
        parcels_.side_m_ * glm::dvec3(parcels_.mixed_[static_cast<std::size_t>(number)]);
    for (const auto& division : parcels_.divisions_) {
      const int n = division.cells;
      const double side_m = parcels_.side_m_ / n;
      for (int i = 0; i < n * n * n; ++i) {
        *codes++ = code({corner + side_m * (cell_number(i, n) + 0.5), side_m}, patches);
      }
    }
  }

 private:
  int code(const Cube& cube, std::vector<SurfacePatch>& patches) const {
    const auto margin_m = static_cast<double>(parcels_.half_sheet_m_);
    const CubeTissue tissue = study_cube(*parcels_.map_, cube, margin_m);
    if (tissue.material) return *tissue.material;
    if (!tissue.cut) return TissueParcels::kIntricate;
    patches.push_back(patch(*tissue.cut));
    return TissueParcels::kIntricate - static_cast<int>(patches.size());
  }

  SurfacePatch patch(const CutCube& cut) const {
    const Parabola& d = cut.distance;
    const auto f = [](double x) { return static_cast<float>(x); };
    return {f(d.at),
            f(d.slope.x),
            f(d.slope.y),
            f(d.slope.z),
            f(d.square.x),
            f(d.square.y),
            f(d.square.z),
            f(d.product.x),
            f(d.product.y),
            f(d.product.z),
            parcels_.amplitude(cut.inside),
            parcels_.amplitude(cut.outside),
            static_cast<std::int16_t>(cut.inside),
            static_cast<std::int16_t>(cut.outside)};
  }

  const TissueParcels& parcels_;
};

void TissueParcels::find_codes(int threads) {
  codes_.resize(mixed_.size() * codes_per_parcel_);
  std::vector<std::vector<SurfacePatch>> patches(mixed_.size());
  const PatchMaker maker(*this);
  parallel_ranges(static_cast<int>(mixed_.size()), threads, [&](int first, int last) {
    for (int m = first; m < last; ++m) {
      const auto at = static_cast<std::size_t>(m);
      maker.make(m, codes_.data() + at * codes_per_parcel_, patches[at]);
    }
  });
  for (std::size_t m = 0; m < patches.size(); ++m) {
    const auto before = static_cast<std::int32_t>(patches_.size());
    for (std::size_t i = 0; i < codes_per_parcel_; ++i) {
      std::int32_t& code = codes_[m * codes_per_parcel_ + i];
      if (code < kIntricate) code -= before;
    }
    patches_.insert(patches_.end(), patches[m].begin(), patches[m].end());
  }
  patches_.shrink_to_fit();
}

float TissueParcels::sheet_power(phantoms::MaterialIndex inside,
                                 phantoms::MaterialIndex outside,
                                 const glm::vec3& gradient,
                                 const glm::vec3& direction) const {
  const float length = glm::length(gradient);
  const float along = glm::dot(gradient, direction);
  const float cosine = length > 0 ? std::min(std::abs(along) / length, 1.0f) : 1.0f;
  const auto before = static_cast<std::size_t>(along < 0 ? outside : inside);
  const auto behind = static_cast<std::size_t>(along < 0 ? inside : outside);
  const float place = cosine * kCosines;
  const int i = std::min(static_cast<int>(place), kCosines - 1);
  const float* value = sheets_.data() + (before * power_.size() + behind) * (kCosines + 1) + i;
  return value[0] + (place - static_cast<float>(i)) * (value[1] - value[0]);
}

float TissueParcels::sheet_amplitude(const SurfacePatch& patch,
                                     const CellOffset& offset,
                                     const glm::vec3& direction) const {
  const glm::vec3 place = place_in_cell(offset);
  const auto material =
      static_cast<std::size_t>(distance(patch, place) < 0 ? patch.inside : patch.outside);
  const float sheet = sheet_power(patch.inside, patch.outside, gradient(patch, place), direction);
  return std::sqrt(power_[material] + sheet);
}

float TissueParcels::power_at(const glm::dvec3& rest_m, const glm::vec3& direction) const {
  const glm::ivec3 index = map_->cell_at(rest_m);
  const glm::vec3 local((rest_m - map_->origin_m()) / map_->cell_m() - glm::dvec3(index));
  const TissueMap::Cell& cell = map_->cell(index);
  phantoms::MaterialIndex material = cell.base;
  float sheet = 0;
  for (const TissueMap::Entry& entry : map_->entries(cell)) {
    const float from_surface_m = map_->value_m(entry, local);
    if (std::abs(from_surface_m) < half_sheet_m_ && entry.inside != material) {
      const glm::vec3 outwards = map_->distance(entry, local).gradient;
      sheet = sheet_power(entry.inside, material, outwards, direction);
    } else if (from_surface_m < 0) {
      sheet = 0;  // painted over
    }
    if (from_surface_m < 0) material = entry.inside;
  }
  return power_[static_cast<std::size_t>(material)] + sheet;
}

float TissueParcels::amplitude_at(const Parcel& parcel,
                                  int octave,
                                  int cell,
                                  const CellOffset& offset,
                                  const glm::vec3& direction) const {
  const int known = code(parcel, octave, cell);
  if (known >= 0) return amplitude(known);
  if (known < kIntricate) {
    const SurfacePatch& cut = patch(known);
    const float from_surface_m = distance(cut, place_in_cell(offset));
    if (std::abs(from_surface_m) < half_sheet_m_) return sheet_amplitude(cut, offset, direction);
    return from_surface_m < 0 ? cut.inside_amplitude : cut.outside_amplitude;
  }
  const int n = divisions_[static_cast<std::size_t>(octave)].cells;
  const glm::dvec3 within = 0.5 + 0.5 * glm::dvec3(place_in_cell(offset));
  const glm::dvec3 place = (cell_number(cell, n) + within) / static_cast<double>(n);
  return std::sqrt(power_at(origin_m_ + side_m_ * (glm::dvec3(parcel.index) + place), direction));
}

std::size_t TissueParcels::bytes() const {
  return kinds_.size() * sizeof(kinds_[0]) + codes_.size() * sizeof(codes_[0]) +
         patches_.size() * sizeof(SurfacePatch);
}

}  // namespace wobblebench::sim
