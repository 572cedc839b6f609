// Writes what a board sends to a file.
#include <csignal>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "base/number_text.h"
#include "bench/cli/commands.h"
#include "bench/cli/common_options.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/simulated_sticks.h"
#include "bench/report/output_folder.h"
#include "bench/report/progress.h"
#include "bench/report/record_report.h"
#include "hw/recording/recorder.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  OutputArguments output;
  std::string board = "sim";
  int volumes = 0;  ///< stop after so many; 0: at the end of the stream
};

/// Set by a signal handler, which can reach nothing but a global variable.
volatile std::sig_atomic_t stop_requested = 0;

/// The first signal ends the recording in order; a second one ends the program.
void on_signal(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

std::string progress_text(const hw::RecordingProgress& recorded) {
  return std::to_string(recorded.volumes) + " volumes, " +
         fixed(static_cast<double>(recorded.bytes) / 1e6, 1) + " MB, " +
         std::to_string(recorded.account.lost.total()) + " sticks lost";
}

/// Records to the sink; a failure of the disk is reported with the number of whole volumes written.
hw::RecordingEnd record(hw::Recorder& recorder,
                        RecordingSink& sink,
                        int volumes,
                        Progress& progress) {
  try {
    return progress.step("record", [&](const PartDone& done) {
      return recorder.run([] { return stop_requested != 0; },
                          [&](const hw::RecordingProgress& recorded) {
                            sink.sync();
                            progress.note(progress_text(recorded));
                            if (volumes > 0) done(recorded.volumes, std::size_t(volumes));
                          });
    });
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; it holds " +
                             std::to_string(recorder.progress().volumes) +
                             " whole volumes, which `inspect --salvage` copies");
  }
}

int record_board(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  const BoardArguments board = parse_board(arguments.board);
  if (arguments.volumes > 0 && !scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes;
  }
  // What does not exist is refused before the folder is made; what takes long comes after it.
  auto link = is_simulated(board) ? nullptr : open_outside_link(board);
  OutputFolder out(arguments.output.folder);
  Progress progress;
  if (is_simulated(board)) {
    link = progress.step("open", [&] { return open_board_link(board, simulated_sticks(scene)); });
  }
  RecordingSink sink(out.directory() / kRecordingName);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  hw::Recorder recorder(
      *link, [&](auto bytes) { sink.write(bytes); }, {.volumes = arguments.volumes});
  const hw::RecordingEnd end = record(recorder, sink, arguments.volumes, progress);
  const hw::RecordingProgress& recorded = recorder.progress();
  if (!recorded.account.balanced()) throw std::logic_error("recording: account is not balanced");
  sink.finish();

  const std::string report = record_report(recorded, end, link->capabilities(), std::move(scene));
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : record_summary(recorded, end, sink.path()));
  if (end != hw::RecordingEnd::lost) return 0;
  std::cerr << "wobblebench: --board = " << arguments.board << ": " << link->loss() << "\n";
  return 1;
}

}  // namespace

Command add_record_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(app, "record", "Write what a board sends to recording.wbst");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output);
  add_board_option(command, arguments->board);
  add_integer(command,
              "--volumes",
              arguments->volumes,
              "Stop after so many; 0: at the end of the stream, or at Ctrl-C",
              0,
              1000);
  return {&command, [arguments] { return record_board(*arguments); }};
}

}  // namespace wobblebench::bench
