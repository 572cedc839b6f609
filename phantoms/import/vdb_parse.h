// Reads an OpenVDB file, by OpenVDB, into a message. Runs in wobblebench-import only.
#pragma once

#include <filesystem>

#include "phantoms/io/message.h"

namespace wobblebench::phantoms {

/// Without delayed loading. Throws std::invalid_argument with one line for a file that is not
/// readable, truncated, or would take more than kMostBytes.
void write_vdb_message(const std::filesystem::path& path, MessageWriter& out);

}  // namespace wobblebench::phantoms
