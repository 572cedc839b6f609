// The level of the surface on each stick, by the tissue behind its own edge.
#pragma once

#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/beam_width.h"
#include "render/options.h"
#include "render/reconstruction/echo_levels.h"

namespace wobblebench::render {

/// For each stick, [frame * lines + line], the level at which a surface lies: below_tissue_db below
/// the tissue behind the stick's edge, less in a wider beam, whose edges are flatter, and more
/// where sticks lie far apart: between them an edge is the mean of several. Tissue is the greatest
/// mean over 1.5 mm from 0.5 to 3.5 mm behind the edge, averaged with the neighbours on the same
/// surface, and at most the volume's; the level is at least kLowestLevel of the way from fluid to
/// tissue, up to kLowestOfWhite where the gain is so high that tissue is white: its level is not
/// known then, and haze beside it comes near it. Levels are smoothed over the neighbours, the
/// higher ones counting more: a rim, which echoes weakly, takes that of the surface beside it.
/// Sticks without an edge take their neighbours'; without any, the volume's iso_level.
///
/// `frames`: samples in [0, 1]; `edges`: find_stick_edges().
std::vector<double> find_stick_levels(const hw::AcquisitionPlan& plan,
                                      const std::vector<std::vector<float>>& frames,
                                      const std::vector<double>& edges,
                                      const EchoLevels& levels,
                                      const hw::BeamWidths& beam,
                                      const RenderOptions& options);

/// The frames with each stick's samples scaled about the level of fluid, within [0, 1], so that its
/// own level becomes `level`: a surface at `level` among them lies where each stick has its own.
std::vector<std::vector<float>> level_sticks(const hw::AcquisitionPlan& plan,
                                             const std::vector<std::vector<float>>& frames,
                                             const std::vector<double>& stick_levels,
                                             const EchoLevels& levels,
                                             double level);

/// The share of the way from fluid to tissue below which no stick's level lies: with no white
/// sample, and linearly to that with kMuchWhite of tissue's samples (EchoLevels::white).
inline constexpr double kLowestLevel = 0.45, kLowestOfWhite = 0.78, kMuchWhite = 0.1;
/// Two-way -6 dB width of the beam, the greater of both directions, for which
/// RayCastingOptions::below_tissue_db is given; in others the decibels are inverse to the width.
inline constexpr double kWidthOfLevel_m = 2.4e-3;

/// Spacing of sticks or frames from which on the decibels grow, with its square.
inline constexpr double kSparse_m = 4e-3;

}  // namespace wobblebench::render
