// Report and summary of the command `record`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "bench/output/report_parts.h"
#include "bench/scene/scene.h"
#include "hw/link/link.h"
#include "hw/recording/recorder.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

inline constexpr const char* kRecordingName = "recording.wbst";
inline constexpr const char* kIqName = "iq.npy";

struct RecordResult {
  hw::RecordingProgress progress;
  hw::RecordingEnd end = hw::RecordingEnd::end_of_stream;
  hw::LinkCapabilities link;
  std::optional<sim::Fidelity> fidelity;  ///< none: the sticks come from a recording or a card
  bool with_iq = false;
};

/// Volumes of which the recording knows a stick. Of a simulated board: their IQ samples are kept.
std::uint64_t volumes_begun(const hw::RecordingProgress& progress);

/// The text of report.json. `scene`: reported with the probe, the acquisition and, unless it was
/// simulated, the display scale that the recording's configuration gives.
std::string record_report(const RecordResult& result, Scene scene);

/// A few lines for a terminal. `folder`: of the recording.
std::string record_summary(const RecordResult& result, const std::filesystem::path& folder);

}  // namespace wobblebench::bench
