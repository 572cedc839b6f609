#include "bench/cli/stream/stream_page.h"

#include <algorithm>
#include <cmath>

#include "base/number_text.h"
#include "base/units.h"
#include "bench/cli/board_report.h"
#include "bench/results/error.h"
#include "bench/studies/latency/latency_spans_report.h"

namespace wobblebench::bench {

namespace {

constexpr std::size_t kMostPoints = 1000;  // of a line

const char* ages_from(const StreamSummary& summary) {
  return summary.scheduled ? "scheduled emission" : "acquisition";
}

std::string rates(const StreamSummary& summary) {
  if (summary.interval.n == 0) return "- Fewer than two pictures: no rate.\n";
  return "- **" + fixed(summary.volumes_per_s, 2) + " volumes/s**, " +
         fixed(summary.pictures_per_s, 2) + " pictures/s over " + fixed(summary.seconds, 1) +
         " s; standard deviation of the time between pictures " + deviation_text(summary) + "\n";
}

std::string bottleneck(const StreamSummary& summary) {
  const Bottleneck heaviest = bottleneck_of(summary);
  std::string text = "- The rate is limited by: " + heaviest.stage;
  if (std::isfinite(heaviest.times_the_next)) {
    text += ", " + significant(heaviest.times_the_next, 3) + " times the next stage's time";
  }
  return text + "\n";
}

Text overview(const StreamReport& report) {
  const StreamResult& result = report.result;
  std::string text = rates(report.summary) + bottleneck(report.summary) + "- " +
                     std::to_string(result.shown.volumes) + " volumes shown; policy " +
                     std::string(to_string(report.queue.policy)) + "\n";
  if (report.simulated && report.simulated->late_ms > 0) {
    text += "- The simulator was late by " + fixed(report.simulated->late_ms, 0) +
            " ms in all, for which the probe waited: ages hold nothing of that\n";
  }
  if (!result.failure.empty()) text += "- **The stream broke off**: " + result.failure + "\n";
  if (const auto& video = report.video) {
    text += "- Video: `" + video->name + "`, " + fixed(video->seconds, 1) + " s, " + video->codec +
            " by " + video->backend + "\n";
  }
  return {text};
}

Table percentile_table(const StreamSummary& summary) {
  Table table{.name = "ages",
              .caption = "Ages of echoes from " + std::string(ages_from(summary)) +
                         " until the picture is ready, and what follows; wall clock",
              .columns = {{"of"},
                          {"p50_ms", "P50", "ms", 1},
                          {"p90_ms", "P90", "ms", 1},
                          {"p99_ms", "P99", "ms", 1},
                          {"p999_ms", "P99.9", "ms", 1},
                          {"max_ms", "max", "ms", 1},
                          {"n", "pictures"}}};
  const auto add = [&](const char* name, const Percentiles& of) {
    table.add({name, of.p50, of.p90, of.p99, of.p999, of.max, of.n});
  };
  add("oldest echo", summary.age_oldest);
  add("newest echo", summary.age_newest);
  add("picture ready to written", summary.ready_to_written);
  add("from picture to picture", summary.interval);
  return table;
}

Table dropped_table(const StreamResult& result) {
  Table table{.name = "dropped",
              .caption = "What was delivered by the board and not shown",
              .columns = {{"cause"}, {"volumes"}, {"sticks"}}};
  const auto add = [&](const char* cause, const VolumeCount& count) {
    table.add({cause, count.volumes, count.sticks});
  };
  add("superseded before rendering", result.queue.superseded);
  add("superseded before writing", result.superseded_pictures);
  table.add({"left at the end",
             Cell(),
             result.left_sticks + result.queue.left_sticks + result.reader.left_sticks});
  table.add({"not taken from the board", Cell(), result.account.delivered - result.reader.sticks});
  return table;
}

Table queue_table(const StreamResult& result) {
  Table table{.name = "queues", .caption = "Queues", .columns = {{"what"}, {"value", "", "", 3}}};
  table.add({"ring of the board: least free slots", result.reader.least_free_slots});
  table.add({"volumes waiting: most at once", result.queue.most_volumes});
  table.add({"volumes waiting: mean over time", result.queue.mean_volumes});
  table.add({"reader blocked, ms", result.queue.blocked_ms});
  return table;
}

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

Document stream_document(const StreamReport& report, const ResolvedScene& scene) {
  const bool known = scene.subject().has_value();
  Document page{.title = "wobblebench stream: " +
                         (known ? scene.options().phantom.name : std::string("a recording"))};
  page.add(overview(report));
  page.add(Picture{"surface.png", "The surface in the last picture of a whole volume."});
  page.add(Heading{"Ages of the echoes"});
  page.add(ages_figure(report));
  page.add(percentile_table(report.summary));
  page.add(Figure{"spans",
                  "Medians of the spans from the oldest and the newest echo to the picture.",
                  {latency_spans_chart(report.summary.spans)}});
  Table spans = latency_spans_table(report.summary.spans);
  spans.caption = "The ages as spans that follow each other";
  page.add(std::move(spans));
  if (!report.summary.spans.why_unknown.empty()) {
    page.add(Text{"Not known: " + report.summary.spans.why_unknown + "."});
  }
  page.add(Heading{"Stages and queues"});
  page.add(load_table(report.summary));
  page.add(queue_table(report.result));
  page.add(Heading{"Losses"});
  page.add(board_table(report.result.account));
  page.add(dropped_table(report.result));
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
