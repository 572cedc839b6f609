// Writes what a board sends to a file.
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>

#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/record_report.h"
#include "bench/cli/recording_folder.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/stop_signals.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/simulated_sticks.h"
#include "hw/recording/recorder.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim";
  int volumes = 0;  ///< stop after so many; 0: at the end of the stream
  bool iq = false;
  bool replace = false;
  bool fail_on_loss = false;
};

/// Throws UserError where there are no IQ samples to write.
void refuse_iq(const Scene& scene, const BoardArguments& board) {
  if (!is_simulated(board)) {
    throw UserError("--iq: needs --board sim; --board = " + board.text +
                    " sends detected samples only");
  }
  const auto rung = sim::choose_fidelity(scene.simulation, scene.plan(), scene.moves()).rung;
  if (sim::echo_model_type(rung).makes_iq()) return;
  throw UserError("--iq: needs the rung field or higher; the rung is " + sim::to_string(rung) +
                  ", which makes no IQ samples");
}

std::string progress_text(const hw::RecordingProgress& recorded) {
  return std::to_string(recorded.volumes) + " volumes, " +
         fixed(static_cast<double>(recorded.bytes) / 1e6, 1) + " MB, " +
         std::to_string(recorded.account.lost.total()) + " sticks lost";
}

hw::RecordingEnd run(hw::Recorder& recorder, RecordingSink& sink, int volumes, Progress& progress) {
  return progress.step("record", [&](const PartDone& done) {
    return recorder.run(stop_requested, [&](const hw::RecordingProgress& recorded) {
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
                        IqFile* iq,
                        const Arguments& arguments,
                        Progress& progress) {
  const hw::RecordingProgress& recorded = recorder.progress();
  try {
    const auto end = run(recorder, sink, arguments.volumes, progress);
    if (!recorded.account.balanced()) throw std::logic_error("recording: account is not balanced");
    if (iq != nullptr) iq->finish(volumes_begun(recorded));
    if (recorded.configuration) sink.finish(recorded.whole_bytes);
    return end;
  } catch (const std::exception& error) {
    const bool unreadable = dynamic_cast<const hw::UnreadableStream*>(&error) != nullptr;
    const std::string why =
        (unreadable ? "--board = " + arguments.board + ": " : "") + error.what();
    if (!recorded.configuration) throw std::runtime_error(why + "; nothing is recorded");
    sink.keep();
    const bool is_named = why.starts_with(sink.path().string());
    throw std::runtime_error(why + "; " + (is_named ? "it" : sink.path().string()) + " holds " +
                             std::to_string(recorded.volumes) +
                             " whole volumes, which `inspect --salvage` copies");
  }
}

/// `iq`, if given, takes the IQ samples. Sets the fidelity of `result`.
std::unique_ptr<hw::Link> make_simulated_link(const Scene& scene,
                                              const BoardArguments& board,
                                              const CacheArguments& cache,
                                              std::shared_ptr<IqFile> iq,
                                              RecordResult& result) {
  SimulatedScan scan = simulated_scan(scene, open_phantom_cache(cache.most_megabytes()));
  result.fidelity = scan.simulator.fidelity();
  return open_board_link(board, simulated_sticks(std::move(scan), std::move(iq)));
}

/// All files get their names, or none does.
void name_results(OutputFolder& out, const fs::path& partial, const std::string& report) {
  try {
    out.adopt(partial, kRecordingName);
    out.write_text("report.json", report);
    out.commit();
  } catch (const std::exception& error) {
    throw std::runtime_error(error.what() + ("; the recording is " + partial.string()));
  }
}

/// Prints the report, or its summary. Returns the exit code, with a line on stderr unless it is 0.
int verdict(const RecordResult& result,
            const std::string& report,
            const fs::path& folder,
            const std::string& loss,
            const Arguments& arguments) {
  std::cout << (arguments.output.json ? report : record_summary(result, folder));
  if (result.end == hw::RecordingEnd::lost) {
    std::cerr << "wobblebench: --board = " << arguments.board << ": " << loss << "\n";
    return 1;
  }
  const hw::BoardAccount& account = result.progress.account;
  if (!arguments.fail_on_loss || account.lost.total() == 0) return 0;
  std::cerr << "wobblebench: --fail-on-loss: " << account.lost.total() << " of " << account.emitted
            << " sticks were lost\n";
  return 1;
}

int record_board(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  const BoardArguments board = parse_board(arguments.board);
  if (arguments.volumes > 0 && !scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes;
  }
  if (arguments.iq) refuse_iq(scene, board);
  // What does not exist is refused before the folder is made; what takes long comes after it.
  auto link = is_simulated(board) ? nullptr : open_outside_link(board);
  OutputFolder out(arguments.output.folder);
  const fs::path partial = new_partial(out, arguments.replace, arguments.iq);
  if (link) out.refuse_input(board.link.value, kRecordingName);
  Progress progress;
  RecordResult result{.with_iq = arguments.iq};
  std::shared_ptr<IqFile> iq;
  if (arguments.iq) iq = std::make_shared<IqFile>(out.stage(kIqName), scene.plan());
  if (!link) {
    link = progress.step(
        "open", [&] { return make_simulated_link(scene, board, arguments.cache, iq, result); });
  }
  RecordingSink sink(partial);
  stop_in_order();
  hw::Recorder recorder(
      *link, [&](auto bytes) { sink.write(bytes); }, {.volumes = arguments.volumes});
  result.end = record(recorder, sink, iq.get(), arguments, progress);
  result.progress = recorder.progress();
  result.link = link->capabilities();
  const std::string loss = result.end == hw::RecordingEnd::lost ? link->loss() : "";
  if (!result.progress.configuration) {
    throw std::runtime_error("--board = " + arguments.board + ": " +
                             (loss.empty() ? "sent no configuration" : loss) +
                             "; nothing is recorded");
  }
  const std::string report = record_report(result, std::move(scene));
  name_results(out, partial, report);
  return verdict(result, report, out.directory(), loss, arguments);
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
  add_flag(command,
           "--iq",
           arguments->iq,
           "Write the IQ samples of a simulated board, too: iq.npy, for NumPy");
  add_flag(command, "--replace", arguments->replace, "Replace a recording that is in DIR");
  add_flag(command,
           "--fail-on-loss",
           arguments->fail_on_loss,
           "Exit code 1 if sticks were lost; the recording is kept all the same");
  return {&command, [arguments] { return record_board(*arguments); }};
}

}  // namespace wobblebench::bench
