// How well a detection-error model explains scans, fitted to or not.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "bench/evaluation/error_model/detection_model.h"
#include "bench/evaluation/measures/picture_measures.h"

namespace wobblebench::bench {

/// One scan's errors, and what is known of its pixels.
struct ScannedErrors {
  Image<float> error_m;  ///< NaN: no error
  Image<PixelTerms> terms;
  double other_surface_percent = 0;
};

/// A picture against what the probe can see of the truth; means over scans. Percent are of pixels.
struct PictureEffect {
  double median_mm = 0;
  double p95_mm = 0;
  double outside_rms_mm = 0;  ///< outside the band at silhouettes
  double missed_percent = 0;
  double false_percent = 0;

  /// Adds a part of the mean.
  void add(const PictureMeasures& measures, double share);
};

/// How the model does on scans that it was, or was not, fitted to.
struct Judgement {
  std::string name;
  std::string of;    ///< what is new about them
  std::string rung;  ///< empty: of several
  int pixels = 0;
  double other_surface_percent = 0;  ///< left out: errors beyond kOtherSurface_m
  double mean_before_mm = 0, mean_after_mm = 0;
  double rms_before_mm = 0, rms_after_mm = 0;
  double explained_variance = 0;   ///< 1 - sum (e - model)^2 / sum (e - mean)^2
  double removed_mean_square = 0;  ///< 1 - sum (e - model)^2 / sum e^2
  /// Share of the variance that two seeds have in common at a pixel, which is all that a bias could
  /// explain; NaN of one seed.
  double reproducible_variance = 0;
  double within_one_percent = 0;  ///< of pixels within one spread of the bias; normal: 68.3
  double within_two_percent = 0;  ///< 95.4
  PictureEffect found, corrected;

  /// Of what repeats, and so could be explained.
  double explained_of_reproducible() const { return explained_variance / reproducible_variance; }
};

/// Signed error, the model's bias and what is left, of one scan; NaN where there is none.
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

/// Of the pixels that have an error.
Judgement judge(const std::string& name,
                const std::string& of,
                const std::vector<ErrorRow>& rows,
                const DetectionModel& model);
/// Mean correlation of the errors of two scans.
double reproducible_variance(const std::vector<ScannedErrors>& scans);
ResidualPicture residual_picture(const std::string& name,
                                 const ScannedErrors& scan,
                                 const DetectionModel& model);
/// By incidence, range and contrast.
std::vector<ResidualBin> residual_bins(const std::vector<ErrorRow>& rows,
                                       const DetectionModel& model);

}  // namespace wobblebench::bench
