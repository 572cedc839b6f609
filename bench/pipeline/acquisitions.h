// Recordings of several acquisitions, as a source of one.
#pragma once

#include <string>

#include "bench/pipeline/outside_link.h"

namespace wobblebench::bench {

/// The board is a recording with several acquisitions in its first 256 MiB, and none was chosen.
/// Throws UserError where it cannot be read.
bool holds_several_acquisitions(const BoardArguments& board);

/// Of such a board, that its first acquisition is taken; empty: of any other.
std::string acquisitions_warning(const BoardArguments& board);

}  // namespace wobblebench::bench
