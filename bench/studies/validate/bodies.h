// Phantoms of the studies, which scenes cannot name.
#pragma once

#include <string>
#include <vector>

#include "phantoms/phantom.h"

namespace wobblebench::bench {

/// One material everywhere.
phantoms::Phantom open_tissue(const std::string& material = "soft_tissue");

/// A block of tissue in fluid; `half_m`: half its size, about the phantom's origin.
phantoms::Phantom block(const glm::dvec3& half_m, double voxel_m);

/// The same body with other materials: `change` is applied to each of its table.
template <class Change>
phantoms::Phantom with_materials(const phantoms::Phantom& phantom, const Change& change) {
  auto materials = phantom.materials();
  for (auto& material : materials) change(material);
  // Shares the grids with `owner`, which it keeps alive.
  const auto owner = std::make_shared<const phantoms::Phantom>(phantom);
  return {phantom.name(),
          materials,
          phantom.background(),
          phantom.surfaces(),
          phantom.region_of_interest(),
          phantom.suggested_position_m(),
          {owner, &owner->grids()},
          phantom.joint()};
}

}  // namespace wobblebench::bench
