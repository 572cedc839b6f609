// What `wobblebench tables` has beyond wobblebench-tables: volumes from the simulated probe.
#pragma once

#include "base/part_done.h"
#include "bench/pipeline/outside_link.h"
#include "bench/scene/scene.h"
#include "bench/studies/tables/measure.h"
#include "bench/studies/tables/volumes.h"
#include "phantoms/phantom.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

/// Puts the reference settings into the scene. Throws UserError where the scene gives a setting
/// that the tables set.
void take_reference_settings(Scene& scene, const TableRun& run);

/// Scans the phantom once for each number of frames, all over the scene's fan. Throws UserError.
TableVolumes scan_table_volumes(const Scene& scene,
                                const phantoms::Phantom& phantom,
                                const BoardArguments& board,
                                const sim::TissueMapSource& maps = {},
                                const PartDone& done = {});

}  // namespace wobblebench::bench
