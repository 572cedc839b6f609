// Recordings of several acquisitions, as a source of one.
#pragma once

#include <string>

#include "bench/pipeline/outside_link.h"

namespace wobblebench::bench {

/// A warning where the board is a recording of which several acquisitions were found and none was
/// chosen; empty: it is not. Reads the first 256 MiB of the recording.
std::string acquisitions_warning(const BoardArguments& board);

}  // namespace wobblebench::bench
