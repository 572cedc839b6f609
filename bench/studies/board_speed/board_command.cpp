// What the board costs: throughput from a file to the program, and the time from cancel() until the
// waiting thread returns.
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

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

std::string report_of(const Throughput& throughput,
                      const std::vector<CancelTimes>& cancels,
                      Provenance provenance) {
  provenance.board = "recording";
  provenance.seed = 1;
  Json stages = Json::array(), waits = Json::array();
  for (const StageSpeed& stage : throughput.stages) {
    stages.push_back({{"stage", stage.stage},
                      {"median_mb_s", stage.mb_s.median},
                      {"min_mb_s", stage.mb_s.min},
                      {"max_mb_s", stage.mb_s.max}});
  }
  for (const CancelTimes& times : cancels) {
    waits.push_back({{"cancels", times.cancels},
                     {"load_threads", times.load_threads},
                     {"p50_ms", times.p50_ms},
                     {"p99_ms", times.p99_ms},
                     {"p999_ms", times.p999_ms},
                     {"max_ms", times.max_ms}});
  }
  const Json report = {{"schema", kReportSchema},
                       {"command", "board"},
                       {"provenance", to_json(provenance)},
                       {"throughput",
                        {{"bytes", throughput.bytes},
                         {"sticks", throughput.sticks},
                         {"repeats", throughput.repeats},
                         {"stages", stages}}},
                       {"cancel", waits}};
  return report_text(report);
}

std::string markdown_of(const Throughput& throughput,
                        const std::vector<CancelTimes>& cancels,
                        const Provenance& provenance) {
  std::ostringstream text;
  text << "# What the board costs\n\nWritten by `wobblebench board`. CPU: " << provenance.cpu
       << ", " << provenance.threads << " threads. Commit: " << provenance.commit
       << ". Sticks of noise, seed 1; simulated, no card.\n\n## Throughput\n\nA recording of "
       << throughput.sticks << " sticks of the paper (" << fixed(double(throughput.bytes) / 1e6, 0)
       << " MB, in the page cache), all threads on one core; median of " << throughput.repeats
       << " runs, and range. The paper's stream is " << fixed(throughput.stream_mb_s, 1)
       << " MB/s; one lane of PCIe 3.0 carries about " << fixed(kLane_mb_s, 0)
       << " MB/s of payload.\n\n| stage | MB/s | range | ns a stick | times the paper's stream |\n"
          "| --- | ---: | ---: | ---: | ---: |\n";
  const double stick_bytes = double(throughput.bytes) / double(throughput.sticks);
  for (const StageSpeed& stage : throughput.stages) {
    text << "| " << stage.stage << " | " << fixed(stage.mb_s.median, 0) << " | "
         << fixed(stage.mb_s.min, 0) << " to " << fixed(stage.mb_s.max, 0) << " | "
         << fixed(stick_bytes / stage.mb_s.median * 1e3, 0) << " | "
         << fixed(stage.mb_s.median / throughput.stream_mb_s, 0) << " |\n";
  }
  text << "\n## Cancelling\n\nFrom the call of `cancel()` until the thread that waits in `next()` "
          "has "
          "returned, while a card sends in real time; the load are threads that do nothing but "
          "count.\n\n| cancels | load threads | P50 ms | P99 ms | P99.9 ms | max ms |\n"
          "| ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const CancelTimes& times : cancels) {
    text << "| " << times.cancels << " | " << times.load_threads << " | " << fixed(times.p50_ms, 3)
         << " | " << fixed(times.p99_ms, 3) << " | " << fixed(times.p999_ms, 3) << " | "
         << fixed(times.max_ms, 3) << " |\n";
  }
  return text.str();
}

CommandResult measure_and_write(int repeats, OutputFolder& out, Progress& progress) {
  const auto throughput = progress.step("throughput", [&](const PartDone& done) {
    return measure_throughput(kVolumes, repeats, done);
  });
  const auto idle = progress.step(
      "idle cancels", [&](const PartDone& done) { return measure_cancels(kCancels, 0, done); });
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  const auto loaded = progress.step(
      "cancels", [&](const PartDone& done) { return measure_cancels(kCancels, cores, done); });
  const std::vector<CancelTimes> cancels = {idle, loaded};
  const Provenance provenance = provenance_of_this_machine();
  const std::string markdown = markdown_of(throughput, cancels, provenance);
  out.write_text("board.md", markdown);
  return {.report = report_of(throughput, cancels, provenance), .summary = markdown};
}

int measure_board(const Arguments& arguments) {
  return run_in_folder(
      arguments.output,
      {{"throughput", 2.0 + arguments.repeats}, {"idle cancels", 20}, {"cancels", 30}},
      [&](OutputFolder& out, Progress& progress) {
        return measure_and_write(arguments.repeats, out, progress);
      });
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
