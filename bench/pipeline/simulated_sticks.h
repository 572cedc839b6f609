// The sticks of a scene's simulated probe.
#pragma once

#include <memory>

#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/iq_file.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

struct SimulatedScan {
  sim::ProbeSimulator simulator;
  hw::SubjectHash subject;
};

/// Makes phantom and simulator. Throws UserError, InvalidOption.
SimulatedScan simulated_scan(const Scene& given, PhantomCache cache = {});

/// Each call of the result gives a source that begins with volume 0. `iq`: where the IQ samples of
/// its volumes go; null: nowhere.
MakeSticks simulated_sticks(SimulatedScan scan, std::shared_ptr<IqFile> iq = {});

}  // namespace wobblebench::bench
