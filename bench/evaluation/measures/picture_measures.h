// Everything that is measured of one picture against the truth.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/measures/image_similarity.h"
#include "bench/evaluation/measures/regions.h"
#include "bench/evaluation/measures/surface_distance.h"
#include "bench/evaluation/truth/truth.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// The picture against the truth.
struct PictureMeasures {
  DepthError raw;          ///< of pass 2's z
  DepthError filtered;     ///< of pass 3's z
  ImageSimilarity shaded;  ///< of the surface image, with the truth shaded alike; NaN: none
  std::vector<RegionError> regions;
  std::optional<SurfaceDistance> distance;  ///< none: not asked for
};

/// What is dear and may be left out.
struct MeasureChoice {
  bool shaded = true;
  bool distance = true;
};

/// A truth with all that measuring a picture needs of it and that no render setting but the view
/// changes.
struct TrueView {
  Truth truth;
  render::Camera camera;
  std::vector<RegionGroup> regions;

  TrueView(Truth of, const render::Camera& from)
      : truth(std::move(of)), camera(from), regions(region_groups(truth, camera)) {}
};

/// `shaded_truth`: as shade_truth() makes it, if it is known already.
PictureMeasures measure_picture(const render::Picture& picture,
                                const TrueView& view,
                                const render::RenderOptions& options,
                                const MeasureChoice& choice = {},
                                const Image<glm::vec3>* shaded_truth = nullptr);

/// The truth as passes 3 and 4 show it; empty for pictures smaller than the similarity's window.
/// `volume`: the volume picture, which ShadingBase::rendered shades.
Image<glm::vec3> shade_truth(const Truth& truth,
                             const render::RenderOptions& options,
                             const Image<glm::vec3>& volume);

/// Why no true surface is in view that the probe can see; empty: one is.
std::string why_no_surface(const DepthError& error);

}  // namespace wobblebench::bench
