// The detection-error model fitted on some scans and judged on others.
#pragma once

#include <vector>

#include "base/part_done.h"
#include "bench/studies/fit/fit_scans.h"
#include "bench/studies/fit/judgement.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

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
