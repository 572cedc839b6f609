// What a scanner does to detected samples before it shows them: lateral smoothing, averaging of
// frames, quantisation.
#pragma once

#include <span>

#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// Whether any of it changes the samples of these options.
bool changes_samples(const SimulationOptions& options);

/// The options of the receiver before show(): samples are smoothed and averaged before black and
/// white clip them, so that the receiver leaves their compression to show().
SimulationOptions before_show(const SimulationOptions& options);

/// Treats whole frames of one volume, in the order of their acquisition: `samples` are those of
/// the sticks, `frames` frames of them, detected by the options before_show(). Smoothing and
/// averaging of log-compressed samples are means of dB, down to one dynamic range below black. The
/// first frame is averaged with none.
void show(std::span<float> samples,
          int frames,
          const hw::AcquisitionPlan& plan,
          const SimulationOptions& options);

}  // namespace wobblebench::sim
