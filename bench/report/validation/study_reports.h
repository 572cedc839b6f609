// The report of each validation study: checks, points, figures and text from its measurements.
#pragma once

#include "bench/report/validation/study_report.h"
#include "bench/studies/validate/beam/point_targets.h"
#include "bench/studies/validate/beam/rung_agreement.h"
#include "bench/studies/validate/speckle/scatterer_density.h"
#include "bench/studies/validate/speckle/speckle_motion.h"
#include "bench/studies/validate/speckle/speckle_neighbours.h"
#include "bench/studies/validate/speckle/speckle_size.h"
#include "bench/studies/validate/speckle/speckle_statistics.h"
#include "bench/studies/validate/tissue/attenuation.h"
#include "bench/studies/validate/tissue/half_plane.h"
#include "bench/studies/validate/tissue/reflection.h"
#include "bench/studies/validate/tissue/repeatability.h"
#include "bench/studies/validate/tissue/shear.h"

namespace wobblebench::bench {

StudyReport attenuation_report(const AttenuationInputs& inputs = {});
StudyReport losses_report();
StudyReport point_target_report();
StudyReport reflection_report(const ReflectionInputs& inputs = {});
StudyReport repeatability_report(const RepeatabilityInputs& inputs = {});
StudyReport rung_agreement_report();
StudyReport scatterer_density_report(const DensityInputs& inputs = {});
StudyReport shear_report(const ShearInputs& inputs = {});
StudyReport speckle_motion_report(const SpeckleMotionInputs& inputs = {});
StudyReport speckle_size_report();
StudyReport speckle_statistics_report();

}  // namespace wobblebench::bench
