// --board ARGS as what the conformance suite is run on.
#pragma once

#include <string>
#include <vector>

#include "bench/checks/conformance/fixture.h"
#include "bench/pipeline/board_link.h"
#include "bench/scene/scene.h"

namespace wobblebench::bench {

/// A link of its own for each opening. Besides what --board takes elsewhere: "xdma=stand-in", a
/// stand-in for the card's driver that lives as long as the fixture, and "xdma=fifo-stand-in".
/// Throws UserError, also where the first opening fails.
ConformanceFixture fixture_of(const BoardArguments& board, const Scene& scene);

/// The fixture with these faults around each link (hw/link/faults.h).
ConformanceFixture with_faults(const ConformanceFixture& fixture, const std::string& faults);

/// One of each kind of fault, as parse_faults() takes them.
const std::vector<std::string>& each_fault();

}  // namespace wobblebench::bench
