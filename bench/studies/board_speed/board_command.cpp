// What the board costs: throughput from a file to the program, and the time from cancel() until the
// waiting thread returns.
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <utility>

#include "base/number_text.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/report_parts.h"
#include "bench/studies/board_speed/board_speed.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

/// Payload of one lane of PCIe 3.0 (reference 18).
constexpr double kLane_mb_s = 900;

constexpr int kVolumes = 40;
constexpr int kCancels = 10000;

struct Arguments {
  OutputArguments output;
  int repeats = 3;
};

/// A throughput with its range, and what follows from it.
Table stage_table(const Throughput& throughput) {
  const double stick_bytes = double(throughput.bytes) / double(throughput.sticks);
  Table table{.name = "stages",
              .columns = {{"stage"},
                          {"mb_s", "throughput, median (range)", "MB/s", 0},
                          {"ns_a_stick", "a stick", "ns", 0},
                          {"times_the_stream", "times the paper's stream", "", 0}}};
  for (const StageSpeed& stage : throughput.stages) {
    table.add({stage.stage,
               stage.mb_s,
               stick_bytes / stage.mb_s.median * 1e3,
               stage.mb_s.median / throughput.stream_mb_s});
  }
  return table;
}

Table cancel_table(const std::vector<CancelTimes>& cancels) {
  using C = CancelTimes;
  return table_of<C>({.name = "cancels"},
                     cancels,
                     {{{"cancels"}, &C::cancels},
                      {{"load_threads", "load threads"}, &C::load_threads},
                      {{"p50_ms", "P50", "ms", 3}, &C::p50_ms},
                      {{"p99_ms", "P99", "ms", 3}, &C::p99_ms},
                      {{"p999_ms", "P99.9", "ms", 3}, &C::p999_ms},
                      {{"max_ms", "max", "ms", 3}, &C::max_ms}});
}

std::string report_of(const Throughput& throughput, const Table& cancels, Provenance provenance) {
  provenance.board = "recording";
  provenance.seed = 1;
  Json stages = Json::array();
  for (const StageSpeed& stage : throughput.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"median_mb_s", stage.mb_s.median},
                      {"min_mb_s", stage.mb_s.min},
                      {"max_mb_s", stage.mb_s.max}});
  }
  const Json report = {{"schema", kReportSchema},
                       {"command", "board"},
                       {"provenance", to_json(provenance)},
                       {"throughput",
                        {{"bytes", throughput.bytes},
                         {"sticks", throughput.sticks},
                         {"repeats", throughput.repeats},
                         {"stages", stages}}},
                       {"cancel", to_json(cancels)}};
  return report_text(report);
}

BarChart stage_chart(const Throughput& throughput) {
  BarChart chart{.title = "Throughput from a file to the program, one core",
                 .label = "median throughput (MB/s)"};
  BarPart speed{.name = "median of " + std::to_string(throughput.repeats) + " runs"};
  for (const StageSpeed& stage : throughput.stages) {
    chart.rows.push_back(stage.stage);
    speed.values.push_back(stage.mb_s.median);
  }
  chart.parts = {std::move(speed)};
  return chart;
}

Document document_of(const Throughput& throughput,
                     const Table& cancels,
                     const Provenance& provenance) {
  Document document{.title = "What the board costs", .name = "board"};
  const StageSpeed& last = throughput.stages.back();
  document
      .add(KeyFigures{{{"From a file to the program",
                        fixed(last.mb_s.median, 0),
                        "MB/s",
                        "on one core, " + fixed(last.mb_s.median / throughput.stream_mb_s, 0) +
                            " times the paper's stream"}}})
      .add(Text{"Written by `wobblebench board`. CPU: " + provenance.cpu + ", " +
                std::to_string(provenance.threads) + " threads. Commit: " + provenance.commit +
                ". Sticks of noise, seed 1; simulated, no card."})
      .add(Heading{"Throughput"})
      .add(Text{"A recording of " + std::to_string(throughput.sticks) + " sticks of the paper (" +
                fixed(double(throughput.bytes) / 1e6, 0) +
                " MB, in the page cache), all threads on one core; median of " +
                std::to_string(throughput.repeats) + " runs, and range. The paper's stream is " +
                fixed(throughput.stream_mb_s, 1) + " MB/s; one lane of PCIe 3.0 carries about " +
                fixed(kLane_mb_s, 0) + " MB/s of payload."})
      .add(Figure{.name = "throughput",
                  .caption = "Each part of a recording's path does what the one above it does, and "
                             "more.",
                  .panels = {stage_chart(throughput)}})
      .add(stage_table(throughput))
      .add(Heading{"Cancelling"})
      .add(Text{"From the call of `cancel()` until the thread that waits in `next()` has returned, "
                "while a card sends in real time; the load are threads that do nothing but count."})
      .add(cancels);
  return document;
}

CommandResult measure(int repeats, Progress& progress) {
  const auto throughput = progress.step("throughput", [&](const PartDone& done) {
    return measure_throughput(kVolumes, repeats, done);
  });
  const auto idle = progress.step(
      "idle cancels", [&](const PartDone& done) { return measure_cancels(kCancels, 0, done); });
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  const auto loaded = progress.step(
      "cancels", [&](const PartDone& done) { return measure_cancels(kCancels, cores, done); });
  const Table cancels = cancel_table({idle, loaded});
  const Provenance provenance = provenance_of_this_machine();
  const Document document = document_of(throughput, cancels, provenance);
  return {.report = report_of(throughput, cancels, provenance), .document = document};
}

int measure_board(const Arguments& arguments) {
  return run_in_folder(
      arguments.output,
      {{"throughput", 2.0 + arguments.repeats}, {"idle cancels", 20}, {"cancels", 30}},
      [&](OutputFolder&, Progress& progress) { return measure(arguments.repeats, progress); });
}

}  // namespace

Command add_board_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "board", "What the board costs: throughput, and cancelling");
  add_output_options(command, arguments->output);
  add_repeats_option(command, arguments->repeats);
  return {&command, [arguments] { return measure_board(*arguments); }};
}

}  // namespace wobblebench::bench
