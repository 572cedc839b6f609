// The report of the command `stream`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/evaluation/measures/depth_error.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/send/send_report.h"
#include "bench/pipeline/stream/stream_summary.h"
#include "bench/scene/resolved_scene.h"

namespace wobblebench::bench {

/// The error of one volume's picture against the truth at that volume's time.
struct VolumeError {
  std::uint32_t volume = 0;
  double time_s = 0;  ///< of its first stick, on the device's clock
  Measurements found;
};

struct VideoSummary {
  std::string name, codec, backend;
  double seconds = 0;
};

struct StreamReport {
  StreamResult result;
  StreamSummary summary;
  QueueOptions queue;
  std::optional<SimulatedVolume> simulated;  ///< sums over all volumes
  std::optional<VideoSummary> video;
  std::optional<SendReport> sent;
  std::vector<VolumeError> errors;
  std::string why_no_errors;  ///< empty: there are
  bool knows_times = true;    ///< false: line rate and volume time are the plan's alone
};

/// What came and was not shown, and the queues.
void describe(const StreamResult& result, Measurements& to);

/// report.json.
std::string stream_report(const StreamReport& report,
                          Provenance provenance,
                          const ResolvedScene& scene,
                          const StepTimes& times);
/// What matters most, as lines of a name and a text.
std::string stream_headline(const StreamReport& report);
/// For a person, on stdout.
std::string stream_text(const StreamReport& report, const std::filesystem::path& folder);
/// A trace in the format of Chrome's about:tracing, which Perfetto opens: a track for single
/// sticks, frames, pass 1, passes 2 to 4, and the sink. An arrow leads from a frame's first and
/// from its last stick by pass 1 to the picture that shows them: these two bound the ages of the
/// echoes in between, and all 2368 of a default volume would be 1 MB. Bounded by kMostSpans: about
/// 5 MB.
std::string stream_trace(const StreamResult& result);

}  // namespace wobblebench::bench
