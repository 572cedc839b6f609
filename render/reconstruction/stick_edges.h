// The first surface on each stick, found in its polar samples.
#pragma once

#include <limits>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "render/options.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::render {

/// Range of the edge on a stick that has none.
inline constexpr double kNoEdge = std::numeric_limits<double>::quiet_NaN();

/// For each stick, [frame * lines + line], the range of its first edge in the volume of interest,
/// m, or kNoEdge: where the mean over 1 mm passes the level `fraction` of the way from fluid to
/// tissue, the 3 mm behind are beyond it and the 3 mm before are not. Edges of the given sign.
///
/// An edge counts only with its neighbours' support: of the eight sticks around it at least a
/// quarter have their edge within 6 mm of its range. Noise and specks have none.
std::vector<double> find_stick_edges(const hw::AcquisitionPlan& plan,
                                     const std::vector<std::vector<float>>& frames,
                                     const std::vector<SampleSpan>& spans,
                                     const EchoLevels& levels,
                                     EdgeSign sign,
                                     double fraction);

/// Lengths of the above, m.
inline constexpr double kEdgeMean_m = 1e-3;
inline constexpr double kEdgeSides_m = 3e-3;
inline constexpr double kSupport_m = 6e-3;

}  // namespace wobblebench::render
