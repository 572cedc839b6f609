// The detection-error model fitted on some scans and judged on others.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/part_done.h"
#include "bench/cache/phantom_cache.h"
#include "bench/evaluation/error_model/detection_model.h"
#include "bench/scene/scene.h"
#include "bench/studies/fit/judgement.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

struct ModelStudy {
  TermChoice choice;
  DetectionModel model;
  int training_scans = 0;
  double step_mm = 0;
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
