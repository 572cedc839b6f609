#include "bench/cli/stream/stream_page.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "bench/cli/board_report.h"
#include "bench/output/document/figures_table.h"
#include "bench/results/error.h"
#include "bench/results/times.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kMostPoints = 1000;  // of a line

Table stream_errors_table(const StreamReport& report) {
  static constexpr const Measure* kShown[] = {&error::kBias,
                                              &error::kMedian,
                                              &error::kRms,
                                              &error::kP95,
                                              &error::kMissed,
                                              &error::kFalse,
                                              &error::kPixels};
  Table table{.name = "errors",
              .caption = "Depth errors of volumes, each against the truth at its own time",
              .columns = columns_of({{"volume"}, {"time_s", "first stick", "s"}}, kShown)};
  for (const VolumeError& error : report.errors) {
    table.add(cells_of({error.volume, error.time_s}, error.found, kShown));
  }
  return table;
}

/// Volumes between those of the pictures.
Series not_shown(const std::deque<PictureTimes>& records) {
  Series series{.name = "not shown", .stroke = Stroke::none, .mark = Mark::triangle, .colour = 6};
  for (std::size_t i = 1; i < records.size(); ++i) {
    for (std::uint32_t v = records[i - 1].volume + 1; v < records[i].volume; ++v) {
      if (series.x.size() < kMostPoints) series.add(v, 0);
    }
  }
  return series;
}

}  // namespace

Table percentile_table(const StreamSummary& summary) {
  Table table{.name = "ages",
              .caption = "Ages of echoes from " + std::string(ages_from(summary)) +
                         " until the picture is ready, and what follows; wall clock",
              .columns = columns_of({{"of"}}, percentile_measures())};
  const auto add = [&](const char* name, const Percentiles& of) {
    table.add(cells_of({name}, described(of), percentile_measures()));
  };
  add("oldest echo", summary.age_oldest);
  add("newest echo", summary.age_newest);
  add("picture ready to written", summary.ready_to_written);
  add("from picture to picture", summary.interval);
  return table;
}

const char* ages_from(const StreamSummary& summary) {
  return summary.scheduled ? "scheduled emission" : "acquisition";
}

Table load_table(const StreamSummary& summary) {
  return table_of<StageLoad>({.name = "loads", .caption = "How long each stage works for a volume"},
                             summary.loads,
                             {{{"stage"}, &StageLoad::stage},
                              {{"ms_per_volume", "time", "ms", 1}, &StageLoad::ms_per_volume}});
}

Figure ages_figure(const StreamReport& report) {
  const auto& records = report.result.records;
  const std::size_t every = records.size() / kMostPoints + 1;
  Series oldest{.name = "oldest echo", .mark = Mark::disc};
  Series newest{.name = "newest echo", .mark = Mark::square};
  for (std::size_t i = 0; i < records.size(); i += every) {
    const PictureTimes& times = records[i];
    if (every == 1 && i > 0 && times.volume > records[i - 1].volume + 1) {
      for (Series* line : {&oldest, &newest}) line->add(times.volume - 1, std::nan(""));  // a gap
    }
    oldest.add(times.volume, age_ms(times.first, times, report.summary.scheduled));
    newest.add(times.volume, age_ms(times.last, times, report.summary.scheduled));
  }
  Chart chart{"Ages when a picture is ready", {.label = "volume"}, {.label = "age (ms)", .low = 0}};
  chart.series = {std::move(oldest), std::move(newest), not_shown(records)};
  std::string caption = "Ages of the oldest and the newest echo of each picture, from " +
                        std::string(ages_from(report.summary)) +
                        "; triangles at 0: volumes that were not shown.";
  if (every > 1) caption += " Every " + std::to_string(every) + "th picture; all are in ages.csv.";
  return {.name = "ages", .caption = caption, .panels = {chart}};
}

namespace {

/// How old what is shown is, how often it changes, and what was lost.
KeyFigures answer_of(const StreamReport& report) {
  const StreamSummary& summary = report.summary;
  const hw::BoardAccount& account = report.result.account;
  const std::string from =
      std::string("From ") + ages_from(summary) + " until the picture is ready";
  KeyFigures answer;
  answer.add("Newest echo, P50", summary.age_newest.p50, times::kP50.key, from)
      .add("Newest echo, P99", summary.age_newest.p99, times::kP99.key, from)
      .add("Volumes shown",
           summary.volumes_per_s,
           times::kVolumesPerS.key,
           "The limit: " + bottleneck_of(summary).stage);
  answer.all.push_back({"Sticks lost",
                        std::to_string(account.lost.total()),
                        "",
                        "Of " + std::to_string(account.emitted) + " that the probe sent"});
  return answer;
}

}  // namespace

Document stream_document(const StreamReport& report, const ResolvedScene& scene) {
  const bool known = scene.subject().has_value();
  Document page{.title = "wobblebench stream: " +
                         (known ? scene.options().phantom.name : std::string("a recording"))};
  page.add(answer_of(report));
  page.add(Picture{"surface.png", "The surface in the last picture of a whole volume."});
  page.add(Heading{"This stream"}).add(Text{summary_list(stream_headline(report))});
  page.add(Heading{"Ages of the echoes"});
  page.add(ages_figure(report));
  page.add(percentile_table(report.summary));
  page.add(Figure{"spans",
                  "Medians of the spans from the oldest and the newest echo to the picture.",
                  {latency_spans_chart(report.summary.spans)}});
  page.add(latency_spans_table(report.summary.spans));
  page.add(Heading{"Stages and queues"});
  page.add(load_table(report.summary));
  page.add(figures_table({.name = "queues", .caption = "Queues, and what came and was not shown"},
                         described(report.result)));
  page.add(Heading{"Losses"});
  page.add(board_table(report.result.account));
  if (report.sent) {
    page.add(Heading{"Sent to other programs"});
    page.add(sent_table(*report.sent));
    page.add(clients_table(*report.sent));
  }
  page.add(Heading{"Depth errors"});
  if (report.errors.empty()) {
    page.add(Text{"None: " + report.why_no_errors + "."});
  } else {
    page.add(stream_errors_table(report));
  }
  page.data.push_back({"ages.csv", stream_ages(report)});
  return page;
}

}  // namespace wobblebench::bench
