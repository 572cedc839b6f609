// Writes what a board sends to a file.
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "bench/cli/commands.h"
#include "bench/cli/common_options.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/simulated_sticks.h"
#include "bench/report/output_folder.h"
#include "bench/report/record_report.h"
#include "hw/recording/recorder.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  OutputArguments output;
  std::string board = "sim";
  int volumes = 0;  ///< stop after so many; 0: at the end of the stream
  bool fail_on_loss = false;
};

/// Set by a signal handler, which can reach nothing but a global variable.
volatile std::sig_atomic_t stop_requested = 0;

/// The first signal ends the recording in order; a second one ends the program.
void on_signal(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

/// The progress of a recording on stderr: one line rewritten on a terminal, a line every few
/// seconds in a log.
class RecordingProgressLine {
 public:
  void show(const hw::RecordingProgress& progress) {
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    const auto now = std::chrono::steady_clock::now();
    if (!terminal && now < next_) return;
    next_ = now + std::chrono::seconds(5);
    std::fprintf(stderr,
                 "%llu volumes, %.1f MB, %llu sticks lost%s",
                 static_cast<unsigned long long>(progress.volumes),
                 static_cast<double>(progress.bytes) / 1e6,
                 static_cast<unsigned long long>(progress.account.lost.total()),
                 terminal ? "   \r" : "\n");
  }

 private:
  std::chrono::steady_clock::time_point next_{};
};

std::string whole_volumes(const hw::Recorder& recorder) {
  return std::to_string(recorder.progress().volumes) +
         " whole volumes, which `inspect --salvage` copies";
}

/// Why a stream cannot be recorded any further. Keeps what came before it, if a packet did.
std::runtime_error unreadable(const std::string& why,
                              const hw::Recorder& recorder,
                              RecordingSink& sink) {
  const hw::RecordingProgress& progress = recorder.progress();
  if (progress.account.emitted > 0 || progress.configuration) {
    return std::runtime_error(why + "; " + sink.partial().string() + " holds " +
                              whole_volumes(recorder));
  }
  sink.discard();
  return std::runtime_error(why);
}

/// Records to the sink; a failure is reported with the number of whole volumes written.
hw::RecordingEnd record(hw::Recorder& recorder, RecordingSink& sink, const std::string& board) {
  RecordingProgressLine line;
  try {
    return recorder.run([] { return stop_requested != 0; },
                        [&](const hw::RecordingProgress& progress) {
                          sink.sync();
                          line.show(progress);
                        });
  } catch (const hw::UnreadableStream& error) {
    throw unreadable("--board = " + board + ": " + error.what(), recorder, sink);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(std::string(error.what()) + "; it holds " + whole_volumes(recorder));
  }
}

int record_board(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  const BoardArguments board = parse_board(arguments.board);
  if (arguments.volumes > 0 && !scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes;
  }
  OutputFolder out(arguments.output.folder);
  const auto link =
      open_board_link(board, is_simulated(board) ? simulated_sticks(scene) : MakeSticks{});
  RecordingSink sink(out.directory() / kRecordingName);
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  hw::Recorder recorder(
      *link, [&](auto bytes) { sink.write(bytes); }, {.volumes = arguments.volumes});
  const hw::RecordingEnd end = record(recorder, sink, arguments.board);
  const hw::RecordingProgress& progress = recorder.progress();
  if (!progress.account.balanced()) throw std::logic_error("recording: account is not balanced");
  sink.finish();

  const std::string report = record_report(progress, end, link->capabilities(), std::move(scene));
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : record_summary(progress, end, sink.path()));
  if (end == hw::RecordingEnd::lost) {
    std::cerr << "wobblebench: --board = " << arguments.board << ": " << link->loss() << "\n";
    return 1;
  }
  if (!arguments.fail_on_loss || progress.account.lost.total() == 0) return 0;
  std::cerr << "wobblebench: --fail-on-loss: " << progress.account.lost.total() << " of "
            << progress.account.emitted << " sticks were lost\n";
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
  add_flag(command,
           "--fail-on-loss",
           arguments->fail_on_loss,
           "Exit code 1 if sticks were lost; the recording is kept all the same");
  return {&command, [arguments] { return record_board(*arguments); }};
}

}  // namespace wobblebench::bench
