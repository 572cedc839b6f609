// The echo of one point: how wide it is along the stick, across it, and across the image plane, and
// how strong, at the places of tests/yardstick/point_widths.csv.
#pragma once

#include <span>
#include <vector>

#include "bench/studies/validate/yardstick.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// A rung, and a choice that it offers.
struct PointRung {
  sim::Rung rung = sim::Rung::scatterers;
  bool side_lobes = false;
};

/// At each of `places`. `scatterers` and `reference`: one point on the axis of the stick, heard by
/// sticks that turn past it in the image plane and by frames that turn past it; -6 dB widths of the
/// peak of the envelope, between the first places on either side of its maximum. `field`: widths
/// of its sim::BeamProfile, by which it blurs what it shows, those of each stick's own beam; NaN
/// along the stick, and for the level.
std::vector<BeamComparison> measure_points(hw::ProbePreset preset,
                                           const PointRung& rung,
                                           std::span<const BeamRow> places);

/// On the rung `scatterers` with the standard probe, in tissue that attenuates so much one way, at
/// places of attenuated_rows(); level over that without attenuation.
std::vector<BeamComparison> measure_attenuated_points(double db_per_cm_mhz,
                                                      std::span<const BeamRow> places);

}  // namespace wobblebench::bench
