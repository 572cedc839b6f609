// What the board costs: throughput from a file to the program, and the time from cancel() until the
// waiting thread returns.
#include <iostream>
#include <memory>
#include <thread>

#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/studies/board_speed/board_speed.h"
#include "bench/studies/board_speed/board_speed_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kVolumes = 40;
constexpr int kCancels = 10000;

struct Arguments {
  OutputArguments output;
  int repeats = 3;
};

int measure_board(const Arguments& arguments) {
  OutputFolder out(arguments.output.folder);
  Progress progress(
      {{"throughput", 2.0 + arguments.repeats}, {"idle cancels", 20}, {"cancels", 30}});
  const auto throughput = progress.step("throughput", [&](const PartDone& done) {
    return measure_throughput(kVolumes, arguments.repeats, done);
  });
  const auto idle = progress.step(
      "idle cancels", [&](const PartDone& done) { return measure_cancels(kCancels, 0, done); });
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  const auto loaded = progress.step(
      "cancels", [&](const PartDone& done) { return measure_cancels(kCancels, cores, done); });
  const std::vector<CancelTimes> cancels = {idle, loaded};
  const Provenance provenance = provenance_of_this_machine();
  const std::string markdown = board_speed_markdown(throughput, cancels, provenance);
  const std::string report = board_speed_report(throughput, cancels, provenance);
  out.write_text("board.md", markdown);
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : markdown);
  return 0;
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
