// The detection-error model fitted on some scans and judged on others.
#pragma once

#include <string>
#include <vector>

#include "base/part_done.h"
#include "bench/fit/detection_model.h"
#include "bench/studies/fit/fit_scans.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// How the model does on scans that it was, or was not, fitted to.
struct Judgement {
  std::string name;
  std::string of;  ///< what is new about them
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

struct ModelStudy {
  DetectionModel model;
  int training_scans = 0;
  double step_mm = 0;
  Judgement training;
  std::vector<Judgement> held_out;
  Judgement all_held_out;
  std::vector<ResidualPicture> pictures;  ///< one of each held-out set
  std::vector<ResidualBin> bins;
};

/// `seeds`: of each training pose. Trains on the scene's phantom at three poses and in another
/// view, and, so that the terms of the settings vary, with twice the buffer, half the frames and
/// half the sticks; judges on other seeds, another pose, another view, and those of a ball, a
/// slanting plane and steps that the scene does not have.
ModelStudy study_detection_model(const Scene& scene,
                                 const LoadedPhantom& phantom,
                                 int seeds,
                                 PhantomCache& cache,
                                 render::GlContext& context,
                                 const PartDone& done);

}  // namespace wobblebench::bench
