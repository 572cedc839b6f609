// The scan that slices are made of: the sticks of a scan and those that are put between them.
#pragma once

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"

namespace wobblebench::render {

/// Steps between sticks and between frames of the denser scan for one of the real scan.
struct DenseFactors {
  int lines = 1, frames = 1;
};

/// The least factors for which neighbours lie within ReconstructionOptions::spacing_m at the far
/// side of the box; no more than 8, and no more sticks or frames than a plan may have. 1 for plain
/// sticks.
DenseFactors dense_factors(const hw::AcquisitionPlan& plan, const RenderOptions& options);

/// Sector and fan stay.
hw::AcquisitionPlan dense_plan(const hw::AcquisitionPlan& plan, const DenseFactors& factors);

}  // namespace wobblebench::render
