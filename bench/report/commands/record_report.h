// Report and summary of the command `record`.
#pragma once

#include <filesystem>
#include <string>

#include "bench/report/report_parts.h"
#include "bench/scene/scene.h"
#include "hw/link/link.h"
#include "hw/recording/recorder.h"

namespace wobblebench::bench {

inline constexpr const char* kRecordingName = "recording.wbst";

/// The text of report.json. `scene`: reported with the probe and the acquisition that the
/// recording's configuration gives.
std::string record_report(const hw::RecordingProgress& progress,
                          hw::RecordingEnd end,
                          const hw::LinkCapabilities& link,
                          Scene scene);

/// Two lines for a terminal. `path`: of the recording.
std::string record_summary(const hw::RecordingProgress& progress,
                           hw::RecordingEnd end,
                           const std::filesystem::path& path);

}  // namespace wobblebench::bench
