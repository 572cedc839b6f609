#include "sim/tissue/tissue_map.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

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
  // Six positions. The four of a tetrahedron would do, but take curvature for slope: an error of
  // 0.3 degrees on a sphere of 20 mm rather than 0.005.
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

}  // namespace wobblebench::sim
