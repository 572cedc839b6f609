// Parts of a picture: about silhouettes, by incidence, by range, by part, and what the probe
// cannot see.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/truth/truth.h"
#include "render/camera.h"

namespace wobblebench::bench {

/// Half width of the band, across the ray: the spacing of frames, and about the width of the beam,
/// at the depth of the default face (docs/decisions/0028-measures.md).
inline constexpr double kBandWidth_m = 3e-3;

/// 1 in the pixels within `width_m` of one where the true surface ends, where its depth jumps by
/// more than kSurfaceJump_m to the next pixel, or which is grazing. The picture's border and pixels
/// that the probe's field does not reach end no surface.
Image<std::uint8_t> silhouette_band(const Truth& truth,
                                    const render::Camera& camera,
                                    double width_m = kBandWidth_m);

/// A division of the picture's pixels.
struct RegionGroup {
  /// "silhouette", "incidence", "range", "part", "face", "unseen", "outline".
  std::string name;
  std::vector<std::string> regions;  ///< names
  Image<std::uint8_t> index;         ///< into `regions`; their number or more: in none
};

/// silhouette: "outside" and "within" the band; incidence: between stick and normal, in bins of 20
/// degrees; range: along the stick, in bins of 20 mm; part: those of a
/// phantom that names them; face: mouth, nose, eyes and ears of a face; unseen: the reasons of
/// TruthKind. A truth that does not know its crossings has the first group alone.
std::vector<RegionGroup> region_groups(const Truth& truth, const render::Camera& camera);

/// Errors of the pixels of one region. Percentages are of the picture's pixels, so that those of a
/// group add up, and of areas within the region.
struct RegionError {
  std::string group;
  std::string name;
  int surface = 0;  ///< pixels with a true surface; of the group `unseen`: that cannot be seen
  int missed = 0;
  int false_surface = 0;  ///< in `silhouette` and `outline` alone: elsewhere there is no true one
  double surface_m2 = 0;
  double missed_m2 = 0;
  DepthStatistics depth;
  NormalStatistics raw_normal;  ///< normals of pass 2's z
  NormalStatistics normal;      ///< normals of pass 3's z

  double missed_surface_percent() const { return 100.0 * missed_m2 / surface_m2; }
  /// Of the region's own pixels.
  double missed_pixels_percent() const { return 100.0 * missed / surface; }
};

/// Regions with neither a true nor a false surface are left out.
std::vector<RegionError> measure_regions(const std::vector<RegionGroup>& groups,
                                         const Truth& truth,
                                         const render::Camera& camera,
                                         const Image<float>& depth_m,
                                         const DepthError& raw,
                                         const DepthError& filtered);

}  // namespace wobblebench::bench
