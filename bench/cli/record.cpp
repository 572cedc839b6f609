// Writes what a board sends to a file.
#include <array>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/commands.h"
#include "bench/cli/common_options.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/simulated_sticks.h"
#include "bench/report/commands/record_report.h"
#include "bench/report/output/output_folder.h"
#include "bench/report/output/progress.h"
#include "hw/recording/recorder.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim";
  int volumes = 0;  ///< stop after so many; 0: at the end of the stream
  bool replace = false;
  bool fail_on_loss = false;
};

constexpr std::array kStopSignals = {SIGINT, SIGTERM, SIGHUP};

/// Set by a signal handler, which can reach nothing but a global variable.
volatile std::sig_atomic_t stop_requested = 0;

/// The first signal ends the recording in order; a second one ends the program.
void on_signal(int signal) {
  stop_requested = 1;
  std::signal(signal, SIG_DFL);
}

void stop_in_order() {
  for (const int signal : kStopSignals) {
    if (std::signal(signal, on_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
  }
}

/// The name of a recording that is not finished. Refuses to touch one that is there.
fs::path new_partial(const OutputFolder& out, bool replace) {
  const fs::path whole = out.directory() / kRecordingName;
  fs::path partial = whole.string() + ".partial";
  const auto refuse = [&](const std::string& what) {
    throw UserError("--out = " + out.directory().string() + ": holds " + what);
  };
  std::error_code ignored;
  // A command was killed after its recording had its final name, before it lost the other.
  if (fs::equivalent(partial, whole, ignored)) fs::remove(partial);
  if (fs::exists(fs::symlink_status(partial, ignored))) {
    refuse(
        "a recording that was not finished; must be a folder without one (`wobblebench inspect " +
        partial.string() + " --salvage NEW` copies what it holds)");
  }
  if (!replace && fs::exists(fs::symlink_status(whole, ignored))) {
    refuse(std::string(kRecordingName) +
           "; must be a folder without one, unless --replace is given");
  }
  return partial;
}

std::string progress_text(const hw::RecordingProgress& recorded) {
  return std::to_string(recorded.volumes) + " volumes, " +
         fixed(static_cast<double>(recorded.bytes) / 1e6, 1) + " MB, " +
         std::to_string(recorded.account.lost.total()) + " sticks lost";
}

hw::RecordingEnd run(hw::Recorder& recorder, RecordingSink& sink, int volumes, Progress& progress) {
  return progress.step("record", [&](const PartDone& done) {
    return recorder.run([] { return stop_requested != 0; },
                        [&](const hw::RecordingProgress& recorded) {
                          sink.sync();
                          progress.note(progress_text(recorded));
                          if (volumes > 0) done(recorded.volumes, std::size_t(volumes));
                        });
  });
}

/// Records to the sink. A failure leaves a partial file that can be salvaged, and says so; without
/// a configuration there is nothing to salvage.
hw::RecordingEnd record(hw::Recorder& recorder,
                        RecordingSink& sink,
                        const Arguments& arguments,
                        Progress& progress) {
  const hw::RecordingProgress& recorded = recorder.progress();
  try {
    const auto end = run(recorder, sink, arguments.volumes, progress);
    if (!recorded.account.balanced()) throw std::logic_error("recording: account is not balanced");
    if (recorded.configuration) sink.finish(recorded.whole_bytes);
    return end;
  } catch (const std::exception& error) {
    const bool unreadable = dynamic_cast<const hw::UnreadableStream*>(&error) != nullptr;
    const std::string why =
        (unreadable ? "--board = " + arguments.board + ": " : "") + error.what();
    if (!recorded.configuration) throw std::runtime_error(why + "; nothing is recorded");
    sink.keep();
    throw std::runtime_error(why + "; " + (unreadable ? sink.path().string() : "it") + " holds " +
                             std::to_string(recorded.volumes) +
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
  const fs::path partial = new_partial(out, arguments.replace);
  if (link) out.refuse_input(board.link.value, kRecordingName);
  Progress progress;
  if (!link) {
    link = progress.step("open", [&] {
      return open_board_link(
          board, simulated_sticks(scene, open_phantom_cache(arguments.cache.most_megabytes())));
    });
  }
  RecordingSink sink(partial);
  stop_in_order();
  hw::Recorder recorder(
      *link, [&](auto bytes) { sink.write(bytes); }, {.volumes = arguments.volumes});
  const hw::RecordingEnd end = record(recorder, sink, arguments, progress);

  const hw::RecordingProgress& recorded = recorder.progress();
  const std::string loss = end == hw::RecordingEnd::lost ? link->loss() : "";
  if (!recorded.configuration) {
    throw std::runtime_error("--board = " + arguments.board + ": " +
                             (loss.empty() ? "sent no configuration" : loss) +
                             "; nothing is recorded");
  }
  const std::string report = record_report(recorded, end, link->capabilities(), std::move(scene));
  try {
    out.adopt(partial, kRecordingName);
    out.write_text("report.json", report);
    out.commit();
  } catch (const std::exception& error) {
    throw std::runtime_error(error.what() + ("; the recording is " + partial.string()));
  }
  const fs::path recording = out.directory() / kRecordingName;
  std::cout << (arguments.output.json ? report : record_summary(recorded, end, recording));
  if (end == hw::RecordingEnd::lost) {
    std::cerr << "wobblebench: --board = " << arguments.board << ": " << loss << "\n";
    return 1;
  }
  if (!arguments.fail_on_loss || recorded.account.lost.total() == 0) return 0;
  std::cerr << "wobblebench: --fail-on-loss: " << recorded.account.lost.total() << " of "
            << recorded.account.emitted << " sticks were lost\n";
  return 1;
}

}  // namespace

Command add_record_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(app, "record", "Write what a board sends to recording.wbst");
  add_scene_options(command, arguments->scene);
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  add_board_option(command, arguments->board);
  add_integer(command,
              "--volumes",
              arguments->volumes,
              "Stop after so many; 0: at the end of the stream, or at Ctrl-C",
              0,
              1000);
  add_flag(command, "--replace", arguments->replace, "Replace a recording that is in DIR");
  add_flag(command,
           "--fail-on-loss",
           arguments->fail_on_loss,
           "Exit code 1 if sticks were lost; the recording is kept all the same");
  return {&command, [arguments] { return record_board(*arguments); }};
}

}  // namespace wobblebench::bench
