// Everything that is measured of one picture against the truth, and its table.
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/measures/regions.h"
#include "bench/evaluation/measures/surface_distance.h"
#include "bench/evaluation/truth/truth.h"
#include "render/options.h"
#include "render/picture.h"

namespace wobblebench::bench {

/// On luminance in [0, 1]. Same size, at least 11 pixels a side (else std::invalid_argument).
struct ImageSimilarity {
  double ssim =
      0;  ///< mean structural similarity, 11 x 11 Gaussian window of sigma 1.5 (references.md [9])
  double psnr_db = 0;  ///< infinite for equal pictures
};

ImageSimilarity compare_images(const Image<glm::vec3>& a, const Image<glm::vec3>& b);

/// The picture against the truth.
struct PictureMeasures {
  DepthError raw;          ///< error of pass 2's z
  DepthError filtered;     ///< error of pass 3's z
  ImageSimilarity shaded;  ///< surface image against the truth shaded alike; NaN: not formed
  std::vector<RegionError> regions;
  int drawn = 0;                  ///< pixels whose z was not found (render::Picture::drawn)
  double cut_by_box_percent = 0;  ///< Truth::cut_by_box_percent
  std::optional<SurfaceDistance> distance;  ///< none: not asked for
};

/// Which figures of the surface can be formed.
struct ExpectedSurface {
  bool sought = true;  ///< by the renderer; in mode "volume" none is missed
  /// What a detector finds without a surface to detect, among point scatterers, or within tissue
  /// that fills the picture, is neither right nor false.
  bool in_phantom = false;
};

void describe(const PictureMeasures& measures, const ExpectedSurface& expected, Measurements& to);
void describe(const RegionError& region,
              const PictureMeasures& of,
              const ExpectedSurface& expected,
              Measurements& to);

/// Measures that take long and may be left out.
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

/// All figures of a picture.
const std::vector<const Measure*>& picture_measures();
/// In picture_measures(). Throws std::out_of_range.
std::size_t measure_index(std::string_view key);

struct MeasureRow {
  std::string group;           ///< that of RegionError; "picture": the whole picture
  std::string region;          ///< "all" for the whole picture
  std::vector<double> values;  ///< of picture_measures(); NaN: not formed, or not for regions
};

/// The whole picture first, then its regions. Without a surface in view no percentage is formed.
std::vector<MeasureRow> measure_rows(const PictureMeasures& measures);

}  // namespace wobblebench::bench
