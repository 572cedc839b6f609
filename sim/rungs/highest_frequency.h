// How far the pulse's centre falls in a scene at least, to choose the width of the beam by.
#pragma once

#include "hw/probe/acquisition_plan.h"
#include "sim/optics/frequency_course.h"
#include "sim/options.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::sim {

/// The highest, at each range, of some sticks of volume 0 that still have sound there; empty where
/// nothing absorbs. Losses are those of the sticks' axes.
FrequencyCourse highest_frequency(const ScannedTissue& tissue,
                                  const hw::AcquisitionPlan& plan,
                                  const SimulationOptions& options);

}  // namespace wobblebench::sim
