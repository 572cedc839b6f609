// The detection-error model fitted to some scans and judged on others.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "base/part_done.h"
#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/error_model/detection_model.h"
#include "bench/scene/scene.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// Errors of a picture against the part of the truth that the probe can see, means over scans;
/// percent of the pixels.
struct PictureEffect {
  double median_mm = 0;
  double p95_mm = 0;
  double outside_rms_mm = 0;  ///< outside the band at silhouettes
  double missed_percent = 0;
  double false_percent = 0;

  /// NaN: of scans whose pictures are not measured.
  static PictureEffect none() {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone, kNone, kNone, kNone};
  }
};

/// How well the model explains the errors of scans.
struct Judgement {
  std::string name;
  std::string of;    ///< ScanSet::of
  std::string rung;  ///< empty: of several
  int pixels = 0;
  double other_surface_percent = 0;  ///< pixels left out: errors beyond kOtherSurface_m
  double mean_before_mm = 0, mean_after_mm = 0;
  double rms_before_mm = 0, rms_after_mm = 0;
  double explained_variance = 0;   ///< 1 - sum (e - model)^2 / sum (e - mean)^2
  double removed_mean_square = 0;  ///< 1 - sum (e - model)^2 / sum e^2
  /// Share of the variance that two seeds have in common at a pixel, which is all that a bias could
  /// explain; NaN for one seed.
  double reproducible_variance = 0;
  double within_one_percent = 0;  ///< of pixels within one spread of the bias; normal: 68.3
  double within_two_percent = 0;  ///< 95.4
  /// Of one set and rung.
  PictureEffect found = PictureEffect::none(), corrected = PictureEffect::none();

  /// Explained share of the variance that repeats.
  double explained_of_reproducible() const { return explained_variance / reproducible_variance; }
};

/// Signed error of one scan, the model's bias and the difference; NaN where there is none.
struct ResidualPicture {
  std::string name;
  Image<float> error_m, bias_m, left_m;
};

/// Mean error of held-out pixels in a bin of one quantity.
struct ResidualBin {
  std::string quantity;
  double at = 0;  ///< middle
  int pixels = 0;
  double before_mm = 0, after_mm = 0;
};

struct ModelStudy {
  TermChoice choice;
  DetectionModel model;
  int training_scans = 0;
  Judgement training;
  std::vector<Judgement> held_out;  ///< one of each set and rung
  Judgement all_held_out;
  std::vector<ResidualPicture> pictures;  ///< one of each held-out set
  std::vector<ResidualBin> bins;
};

/// `seeds`: of each training set. The terms are chosen, and the model is fitted, on training_sets()
/// alone; then it is judged on held_out_sets(). `others`: names and scenes whose phantoms it is
/// also judged on.
ModelStudy study_detection_model(const Scene& scene,
                                 const std::vector<std::pair<std::string, Scene>>& others,
                                 int seeds,
                                 PhantomCache& cache,
                                 render::GlContext& context,
                                 const PartDone& done);

}  // namespace wobblebench::bench
