// The fixture of the conformance suite for --board ARGS.
#pragma once

#include <string>
#include <vector>

#include "bench/board_checks/conformance/fixture.h"
#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// A new link for each opening. Besides what --board takes elsewhere: "xdma=stand-in", the emulated
/// driver of the card, which lives as long as the fixture, and "xdma=fifo-stand-in". Throws
/// UserError, also if the first opening fails.
ConformanceFixture fixture_of(const BoardArguments& board, const Scene& scene);

/// The fixture with these faults injected into each link (hw/link/faults.h).
ConformanceFixture with_faults(const ConformanceFixture& fixture, const std::string& faults);

/// One of each kind of fault, as parse_faults() takes them.
const std::vector<std::string>& each_fault();

}  // namespace wobblebench::bench
