// Report and summary of the command `inspect`.
#pragma once

#include <filesystem>
#include <string>

#include "hw/recording/recording.h"

namespace wobblebench::bench {

/// The text of report.json.
std::string inspection_report(const std::filesystem::path& path,
                              const hw::RecordingContents& contents);

/// A few lines for a terminal.
std::string inspection_summary(const std::filesystem::path& path,
                               const hw::RecordingContents& contents);

}  // namespace wobblebench::bench
