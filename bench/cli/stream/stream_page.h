// What report.html of the command `stream` shows.
#pragma once

#include "bench/cli/stream/stream_report.h"
#include "bench/output/document/document.h"

namespace wobblebench::bench {

/// Ages, rates, queues, losses and errors of a stream, whose surface.png is staged; ages.csv.
Document stream_document(const StreamReport& report, const ResolvedScene& scene);

/// ages.csv: a line for each picture of StreamResult::records, with its times in ms after the
/// stream began, the time of each pass, and the ages of its oldest and newest echo as the summary
/// has them. Empty: the link does not say when a stick is fired, or the stick was lost.
Table stream_ages(const StreamReport& report);

/// From when a stick was scheduled to be fired, or else acquired, until the picture was ready.
double age_ms(const StickTimes& stick, const PictureTimes& times, bool scheduled);

/// "scheduled emission" or "acquisition".
const char* ages_from(const StreamSummary& summary);

/// Percentiles of the ages, and of what follows.
Table percentile_table(const StreamSummary& summary);
Table load_table(const StreamSummary& summary);

/// Ages of the oldest and the newest echo of each picture, and the volumes that were not shown.
Figure ages_figure(const StreamReport& report);

}  // namespace wobblebench::bench
