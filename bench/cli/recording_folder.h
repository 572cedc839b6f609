// The folder that `record` writes to.
#pragma once

#include <filesystem>

#include "bench/output/output_folder.h"

namespace wobblebench::bench {

/// The name of a recording that is not finished. Throws UserError where the folder holds one, a
/// finished one that is not to be replaced, or the IQ samples of one that would not be replaced
/// with it.
std::filesystem::path new_partial(const OutputFolder& out, bool replace, bool with_iq);

}  // namespace wobblebench::bench
