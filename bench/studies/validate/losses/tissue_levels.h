// What attenuation leaves of the echo of uniform tissue, by material and preset.
#pragma once

#include <string>

#include "bench/studies/validate/common/study_report.h"
#include "hw/probe/probe.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Adds a check for each rung that makes speckle and each preset: the largest difference from
/// TissueBand over brain, soft tissue and uterine wall up to 140 mm.
void add_tissue_levels(StudyReport& report);

}  // namespace wobblebench::bench
