// The rise from fluid to tissue that the beam of the rung `scatterers` gives, side by side with the
// Gaussian of the bound.
#pragma once

#include "bench/evaluation/bound/detection_bound.h"
#include "sim/beam/table/beam_table.h"

namespace wobblebench::bench {

/// Of a stick at a range, for a surface of this slope: the tabulated beam's power, at the delay of
/// its wave front, over the places of a plane; with the pulse's power.
EdgeRise beam_rise(const sim::BeamTable& beam,
                   double theta_rad,
                   double range_m,
                   const StickSlope& slope,
                   double pulse_fwhm_m);

}  // namespace wobblebench::bench
