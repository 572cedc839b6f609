// The report of each validation study: checks, points, figures and text from its measurements.
#pragma once

#include "bench/studies/validate/attenuation.h"
#include "bench/studies/validate/losses.h"
#include "bench/studies/validate/point_targets.h"
#include "bench/studies/validate/reflection.h"
#include "bench/studies/validate/repeatability.h"
#include "bench/studies/validate/rung_agreement.h"
#include "bench/studies/validate/scatterer_density.h"
#include "bench/studies/validate/shear.h"
#include "bench/studies/validate/speckle_motion.h"
#include "bench/studies/validate/speckle_neighbours.h"
#include "bench/studies/validate/speckle_size.h"
#include "bench/studies/validate/speckle_statistics.h"
#include "bench/studies/validate/study_report.h"

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
