// Parts of a picture: about silhouettes, by incidence, by range, by feature, and what the probe
// cannot see.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/truth/truth.h"

namespace wobblebench::bench {

/// A division of the picture's pixels.
struct RegionGroup {
  std::string name;                  ///< "silhouette", "incidence", "range", "feature", "unseen"
  std::vector<std::string> regions;  ///< names
  Image<std::uint8_t> index;         ///< into `regions`; their number or more: in none
};

/// silhouette: "outside" and "within" the band; incidence: between stick and normal, in bins of 20
/// degrees; range: along the stick, in bins of 20 mm; feature: the phantom's, and "rest", where it
/// has some; unseen: the reasons of TruthKind. A truth that does not know its crossings has the
/// first group alone.
std::vector<RegionGroup> region_groups(const Truth& truth, const render::Camera& camera);

/// Of the pixels of one region. Percentages are of the picture's pixels, so that those of a group
/// add up, and of areas within the region.
struct RegionError {
  std::string group;
  std::string name;
  int surface = 0;  ///< pixels with a true surface; of the group `unseen`: that cannot be seen
  int missed = 0;
  int false_surface = 0;  ///< of the group `silhouette` alone: elsewhere there is no true surface
  double surface_m2 = 0;
  double missed_m2 = 0;
  DepthStatistics depth;
  NormalStatistics raw_normal;  ///< of pass 2's z
  NormalStatistics normal;      ///< of pass 3's z

  double missed_surface_percent() const { return 100.0 * missed_m2 / surface_m2; }
};

/// Regions with neither a true nor a false surface are left out.
std::vector<RegionError> measure_regions(const std::vector<RegionGroup>& groups,
                                         const Truth& truth,
                                         const render::Camera& camera,
                                         const Image<float>& depth_m,
                                         const DepthError& raw,
                                         const DepthError& filtered);

}  // namespace wobblebench::bench
