// The last step of every report.json: what two equal runs do not have in common is put apart.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/progress.h"
#include "bench/results/check.h"

namespace wobblebench::bench {

/// Moves what two equal runs do not have in common to "timing", where it keeps its path:
/// `render.frame_ms` becomes `timing.render.frame_ms`. Without "timing" and "provenance" the
/// reports of two equal runs are equal. What is moved depends on the report's "command".
void move_to_timing(nlohmann::ordered_json& report);

/// Whether a report holds times of more than the command's steps, after move_to_timing().
bool measures_times(const nlohmann::ordered_json& report);

/// The text of report.json, from the text that a command made: with move_to_timing(), with the
/// command's checks unless it has a list of its own, with its warnings and, where it holds times,
/// with the use of the machine as "provenance.load". Warns where times were measured on a busy
/// machine.
std::string finished_report(const std::string& report,
                            const std::vector<Check>& checks,
                            Progress& progress);

}  // namespace wobblebench::bench
