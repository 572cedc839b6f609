// What `compare --history` keeps: the figures of one commit after the other, a file each.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/output/document/document.h"
#include "bench/studies/compare/limits_file.h"
#include "bench/studies/compare/run_figures.h"

namespace wobblebench::bench {

struct HistoryRecord {
  std::string measured_at;  ///< UTC, ISO 8601: "2026-11-29T09:30:00Z"
  MeasuredSide side;
};

/// The records of a folder by their time; none where there is no folder. Throws UserError "FILE:
/// reason" for one that cannot be read.
std::vector<HistoryRecord> read_history(const std::filesystem::path& folder);

/// The earlier records: all but that of the commit of `now`.
std::vector<HistoryRecord> before(std::vector<HistoryRecord> history, const MeasuredSide& now);

/// Of each scene and seed of `now` a run with the median of each figure over the earlier runs with
/// the same settings. No runs where there are none. Times are in it; they are of other hours.
MeasuredSide median_side(const std::vector<HistoryRecord>& earlier, const MeasuredSide& now);

/// As COMMIT_SETTINGS.json in the folder, which is made if it is missing; whole, or not at all.
/// Throws std::runtime_error where it cannot be written.
void write_record(const std::filesystem::path& folder, const HistoryRecord& record);

/// Now, as HistoryRecord has it.
std::string utc_now();

/// A figure for each scene: each limited figure over the commits, and where the limit lies from
/// `median`, that of median_side().
std::vector<Figure> history_figures(const std::vector<HistoryRecord>& earlier,
                                    const MeasuredSide& median,
                                    const MeasuredSide& now,
                                    const std::vector<ChangeLimit>& limits);

}  // namespace wobblebench::bench
