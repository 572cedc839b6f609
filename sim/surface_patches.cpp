#include "sim/surface_patches.h"

#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace wobblebench::sim {

namespace {

constexpr int kSamples = 15;  // the centre, six faces, eight corners
constexpr double kFit_m = 30e-6;
/// A surface that a cube's samples leave at this share of their spacing does not come closer
/// between.
constexpr double kSpacing = 0.8;

// In place of a surface's number.
constexpr int kNone = -1;
constexpr int kSeveral = -2;

glm::dvec3 sample_place(int i) {
  if (i == 0) return glm::dvec3(0);
  if (i < 7) {
    glm::dvec3 face(0);
    face[(i - 1) / 2] = i % 2 == 0 ? 1 : -1;
    return face;
  }
  const int corner = i - 7;
  return {corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1};
}

using Values = std::array<double, kSamples>;

/// Least squares over the samples; the normal equations fall apart by symmetry.
Parabola fit(const Values& d) {
  Parabola result;
  glm::dvec3 faces(0);
  double corners = 0;
  for (int i = 1; i < kSamples; ++i) {
    const glm::dvec3 r = sample_place(i);
    const double value = d[static_cast<std::size_t>(i)];
    result.slope += r * value / 10.0;
    if (i < 7) {
      faces[(i - 1) / 2] += 0.5 * value;
    } else {
      corners += value / 8;
      result.product += glm::dvec3(r.x * r.y, r.y * r.z, r.x * r.z) * value / 8.0;
    }
  }
  const double sum = faces.x + faces.y + faces.z;
  result.at = (13 * d[0] + 16 * sum - 16 * corners) / 45;
  const double squares = (sum - 15 * result.at + 12 * corners) / 13;
  result.square = faces - result.at - 4 * (result.at + squares - corners);
  return result;
}

double value(const Parabola& p, const glm::dvec3& r) {
  return p.at + glm::dot(p.slope, r) + glm::dot(p.square, r * r) +
         glm::dot(p.product, glm::dvec3(r.x * r.y, r.y * r.z, r.x * r.z));
}

/// What the map knows at a place.
struct Sample {
  phantoms::MaterialIndex material;
  const TissueMap::Cell* cell;
  glm::vec3 local;
};

Sample sample(const TissueMap& map, const glm::dvec3& rest_m) {
  const glm::ivec3 index = map.cell_at(rest_m);
  Sample result;
  result.cell = &map.cell(index);
  result.local = glm::vec3((rest_m - map.origin_m()) / map.cell_m() - glm::dvec3(index));
  result.material = result.cell->base;
  for (const TissueMap::Entry& entry : map.entries(*result.cell)) {
    if (map.value_m(entry, result.local) < 0) result.material = entry.inside;
  }
  return result;
}

/// Collects what the samples of one cube say.
class CubeStudy {
 public:
  CubeStudy(const TissueMap& map, const Cube& cube, double margin_m) : map_(map) {
    near_m_ = margin_m + kSpacing * 0.5 * cube.side_m;
    for (int i = 0; i < kSamples; ++i) {
      // Corners lie in the cube, not on the border to its neighbour.
      const glm::dvec3 inwards = sample_place(i) * (0.5 * cube.side_m * (1 - 1e-6));
      samples_[static_cast<std::size_t>(i)] = sample(map, cube.center_m + inwards);
    }
  }

  /// The only surface that comes near any sample, or kNone, or kSeveral.
  int surface() const {
    int found = kNone;
    for (const Sample& at : samples_) {
      for (const TissueMap::Entry& entry : map_.entries(*at.cell)) {
        if (std::abs(static_cast<double>(map_.value_m(entry, at.local))) > near_m_) continue;
        if (found != kNone && found != entry.surface) return kSeveral;
        found = entry.surface;
      }
    }
    return found;
  }

  std::optional<phantoms::MaterialIndex> common_material() const {
    for (const Sample& at : samples_) {
      if (at.material != samples_[0].material) return {};
    }
    return samples_[0].material;
  }

  std::optional<CutCube> cut(int surface) const {
    CutCube result;
    Values distances;
    int inside = -1, outside = -1;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const auto distance = distance_to(surface, samples_[i]);
      if (!distance) return {};
      distances[i] = *distance;
      int& side = *distance < 0 ? inside : outside;
      if (side >= 0 && side != samples_[i].material) return {};
      side = samples_[i].material;
    }
    result.inside = inside >= 0 ? inside : outside;
    result.outside = outside >= 0 ? outside : inside;
    result.distance = fit(distances);
    for (int i = 0; i < kSamples; ++i) {
      const double fitted = value(result.distance, sample_place(i));
      if (std::abs(fitted - distances[static_cast<std::size_t>(i)]) > kFit_m) return {};
    }
    return result;
  }

 private:
  std::optional<double> distance_to(int surface, const Sample& at) const {
    for (const TissueMap::Entry& entry : map_.entries(*at.cell)) {
      if (entry.surface == surface) return static_cast<double>(map_.value_m(entry, at.local));
    }
    return {};
  }

  const TissueMap& map_;
  double near_m_;
  std::array<Sample, kSamples> samples_;
};

}  // namespace

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

CubeTissue study_cube(const TissueMap& map, const Cube& cube, double margin_m) {
  if (const auto material = one_material(map, cube, margin_m)) return {material, {}};
  const CubeStudy study(map, cube, margin_m);
  const int surface = study.surface();
  if (surface == kSeveral) return {};
  if (surface == kNone) return {study.common_material(), {}};
  return {{}, study.cut(surface)};
}

}  // namespace wobblebench::sim
