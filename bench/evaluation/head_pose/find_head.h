// Where a fetal head lies in a scan of which nothing else is known: the view and the box that show
// it upright and whole.
#pragma once

#include <string>
#include <vector>

#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// The settings of view and box for the head in these echoes, in whole degrees and millimetres, as
/// --set takes them: seen from before, with all of its face and its ears. Lays the mean head onto
/// the surfaces that face the probe behind fluid, from several hundred orientations, and takes what
/// matches best. Some 0.7 s. Throws UserError, `asked_by` before it, where nothing matches as a
/// head does, or where a head matches as well in another orientation.
std::vector<std::string> find_head_view(const hw::AcquisitionPlan& plan,
                                        const std::vector<hw::PolarFrame>& frames,
                                        const std::string& asked_by);

}  // namespace wobblebench::bench
