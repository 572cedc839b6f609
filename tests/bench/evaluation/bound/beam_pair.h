// The covariance that the beam of the rung `scatterers` gives an edge, beside the Gaussian one of
// the bound: the tabulated responses over the band, with the longer pulses off the axis.
#pragma once

#include "bench/evaluation/bound/detection_bound.h"
#include "sim/optics/beam_table.h"

namespace wobblebench::bench {

/// Pair of a stick at a range, for a surface of this slope, between samples of this spacing;
/// distances are rounded to whole samples. The integral over scatterers in the tissue of the
/// product of their echoes.
EdgePair beam_pair(const sim::BeamTable& beam,
                   const sim::PulseBand& band,
                   const hw::PolarPoint& point,
                   const StickSlope& slope,
                   double spacing_m);

}  // namespace wobblebench::bench
