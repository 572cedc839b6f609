// Writes what a board sends to a file.
#include <algorithm>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number_text.h"
#include "base/text.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/board_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/program.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/output_folder.h"
#include "bench/output/report.h"
#include "bench/output/report_parts.h"
#include "bench/pipeline/board_link.h"
#include "bench/pipeline/iq_file.h"
#include "bench/pipeline/recording_sink.h"
#include "bench/pipeline/scene_warnings.h"
#include "bench/pipeline/stick_sources.h"
#include "bench/scene/scene.h"
#include "hw/link/link.h"
#include "hw/recording/recorder.h"
#include "hw/recording/recording.h"
#include "sim/fidelity.h"
#include "sim/rungs/echo_model.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

constexpr const char* kRecordingName = "recording.wbst";
constexpr const char* kIqName = "iq.npy";
constexpr const char* kReportName = "recording.json";
constexpr std::uintmax_t kMostWithoutStick = 65536;  // bytes of a file that may be removed

struct RecordResult {
  hw::RecordingProgress progress;
  hw::RecordingEnd end = hw::RecordingEnd::end_of_stream;
  hw::LinkCapabilities link;
  std::optional<sim::Fidelity> fidelity;  ///< none: the sticks come from a recording or a card
  bool with_iq = false;
  std::optional<Scene> scene;  ///< as resolved; none: likewise
};

/// Whether a file is a recording whose command was killed before its first stick came, so that
/// nothing can be salvaged from it.
bool holds_no_stick(const fs::path& partial) {
  const fs::file_status status = fs::symlink_status(partial);
  if (!fs::is_regular_file(status) || fs::file_size(partial) > kMostWithoutStick) return false;
  try {
    const hw::RecordingContents contents = hw::inspect_recording(partial);
    return contents.sticks + contents.other_packets == 0 && !contents.unreadable;
  } catch (const hw::LinkOpenError& error) {
    return error.fault() == hw::OpenFault::empty || error.fault() == hw::OpenFault::foreign;
  }
}

/// The name of a recording that is not finished. Throws UserError where the folder holds one, a
/// finished one that is not to be replaced, or the IQ samples of one that would not be replaced
/// with it.
fs::path new_partial(const OutputFolder& out, bool replace, bool with_iq, Progress& progress) {
  const fs::path whole = out.directory() / kRecordingName;
  fs::path partial = whole.string() + ".partial";
  const auto refuse = [&](const std::string& what) {
    throw UserError("--out = " + out.directory().string() + ": holds " + what);
  };
  const auto holds = [](const fs::path& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
  };
  std::error_code ignored;
  // A command was killed after its recording had its final name, before it lost the other.
  if (fs::equivalent(partial, whole, ignored)) fs::remove(partial);
  if (holds_no_stick(partial)) {
    fs::remove(partial);
    progress.warn(partial.string() + " of a killed command held no stick; it was removed");
  }
  if (holds(partial)) {
    refuse(
        "a recording that was not finished; must be a folder without one (`wobblebench inspect " +
        shell_word(partial.string()) + " --salvage NEW` copies what it holds)");
  }
  if (!replace && holds(whole)) {
    refuse(std::string(kRecordingName) +
           "; must be a folder without one, unless --replace is given");
  }
  if (!(replace && with_iq) && holds(out.directory() / kIqName)) {
    refuse(std::string(kIqName) +
           " of another recording; must be a folder without one, unless --replace and --iq are "
           "given");
  }
  return partial;
}

const char* to_string(hw::RecordingEnd end) {
  switch (end) {
    case hw::RecordingEnd::volumes:
      return "as many volumes as asked for";
    case hw::RecordingEnd::end_of_stream:
      return "the stream is over";
    case hw::RecordingEnd::lost:
      return "the device is lost";
    case hw::RecordingEnd::stop_requested:
      return "interrupted";
  }
  return "unknown";
}

/// What a reader of the array has to know.
Json iq_json(const hw::AcquisitionPlan& plan, std::uint64_t volumes) {
  const IqShape shape = iq_shape(plan, volumes);
  const double spacing_mm =
      plan.acquisition().depth_m / static_cast<double>(shape.back()) / kMillimetre;
  return {{"file", kIqName},
          {"type", "complex64"},
          {"axes", {"volume", "frame", "line", "sample"}},
          {"shape", shape},
          {"sample_spacing_mm", spacing_mm},
          {"first_sample_mm", spacing_mm / 2},
          {"center_frequency_mhz", plan.probe().center_frequency_hz / kMegahertz},
          {"phase", "demodulated at the centre frequency, with phase 0 at range 0"},
          {"scale", "1: a perfect mirror; with noise, before envelope detection and TGC"}};
}

/// Volumes of which the recording knows a stick. Of a simulated board: their IQ samples are kept.
std::uint64_t volumes_begun(const hw::RecordingProgress& progress) {
  if (!progress.configuration) return 0;
  const auto sticks = static_cast<std::uint64_t>(progress.configuration->plan.sticks_per_volume());
  return (progress.next_sequence + sticks - 1) / sticks;
}

/// The text of report.json. `scene`: reported with the probe, the acquisition and, unless it was
/// simulated, the display scale that the recording's configuration gives.
std::string record_report(const RecordResult& result, Scene scene) {
  const hw::RecordingProgress& progress = result.progress;
  const hw::Configuration& configuration = progress.configuration.value();
  scene.acquisition = configuration.plan.acquisition();
  static_cast<hw::ProbeOptions&>(scene.probe) = configuration.plan.probe();
  Provenance provenance = provenance_of_this_machine();
  provenance.board = hw::to_string(result.link.origin);
  Json report = report_head("record", provenance, scene);
  const auto is_of_phantom = [](const std::string& key) { return key.starts_with("phantom."); };
  if (!result.scene && std::ranges::none_of(scene.given, is_of_phantom)) {
    for (const char* unknown : {"phantom", "placement", "motion"})
      report["scene"][unknown] = nullptr;
  }
  report["acquisition"] = acquisition_json(scene.plan(), configuration.knows_times);
  report_fidelity(report, result.fidelity);
  if (!result.fidelity) report_stream_scale(report, configuration.display_scale);
  report["board"] = account_json(progress.account);
  report["board"]["damage"] = {{"places", progress.damage.regions},
                               {"bytes_skipped", progress.damage.bytes_skipped}};
  report["board"]["link"] = link_json(result.link);
  report["recording"] = {{"file", kRecordingName},
                         {"bytes", progress.bytes},
                         {"volumes", progress.volumes},
                         {"display_scale", display_scale_json(configuration.display_scale)},
                         {"ended_because", to_string(result.end)}};
  report["iq"] =
      result.with_iq ? iq_json(configuration.plan, volumes_begun(progress)) : Json(nullptr);
  return report_text(report);
}

/// A few lines for a terminal. `folder`: of the recording.
std::string record_summary(const RecordResult& result, const std::filesystem::path& folder) {
  const hw::RecordingProgress& progress = result.progress;
  std::ostringstream text;
  text << "recorded    " << progress.volumes << " volumes, " << progress.account.delivered
       << " sticks, " << static_cast<double>(progress.bytes) / 1e6 << " MB; "
       << progress.account.lost.total() << " sticks lost; " << to_string(result.end) << "\n";
  if (result.fidelity) {
    text << "simulator   " << sim::to_string(result.fidelity->rung) << ": "
         << result.fidelity->reason << "\n";
  }
  text << "samples     from " << hw::to_string(result.link.origin) << "; "
       << display_scale_text(progress.configuration.value().display_scale) << "\n"
       << "recording   " << (folder / kRecordingName).string() << "\n";
  if (result.with_iq) text << "IQ samples  " << (folder / kIqName).string() << "\n";
  return text.str();
}

Document record_document(const RecordResult& result, const std::string& summary) {
  const hw::RecordingProgress& progress = result.progress;
  Table table{.name = "account", .columns = {{"what"}, {"value"}}};
  const auto add = [&](const char* what, const Cell& value) { table.add({what, value}); };
  add("volumes", progress.volumes);
  add("bytes", progress.bytes);
  add("damaged places", progress.damage.regions);
  add("bytes skipped", progress.damage.bytes_skipped);
  Document document{.title = "Recording"};
  document.add(Text{summary_list(summary)})
      .add(std::move(table))
      .add(board_table(progress.account));
  return document;
}

struct RecordArguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim";
  int volumes = 0;  ///< stop after this number; 0: at the end of the stream
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
                        const RecordArguments& arguments,
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
  result.scene = scan.scene;
  return open_board_link(board, simulated_sticks(std::move(scan), std::move(iq)));
}

/// What the files of the command have at least; 0: not known beforehand.
std::uint64_t least_bytes(const BoardArguments& board,
                          const Scene& scene,
                          const RecordArguments& arguments) {
  if (!board.faults.faults.empty()) return 0;  // which may lose packets
  if (!is_simulated(board)) {
    const bool is_whole = board.link.link == "file" && board.link.settings.empty();
    return is_whole && arguments.volumes == 0 ? fs::file_size(board.link.value) : 0;
  }
  const hw::AcquisitionPlan plan = scene.plan();
  const auto volumes = static_cast<std::uint64_t>(
      arguments.volumes > 0 ? std::min(arguments.volumes, scene.acquisition.volumes)
                            : scene.acquisition.volumes);
  const auto sticks = volumes * static_cast<std::uint64_t>(plan.sticks_per_volume());
  const auto samples = static_cast<std::uint64_t>(plan.acquisition().samples_per_stick);
  std::uint64_t iq = arguments.iq ? sizeof(std::complex<float>) : 0;
  for (const std::uint64_t size : iq_shape(plan, volumes)) iq *= size;
  return sticks * samples * sizeof(float) + iq;
}

Scene scene_of(const RecordArguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  if (arguments.volumes > 0 && !scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes;
  }
  return scene;
}

/// Fills the folder from `link`; null: from the scene's simulator.
CommandResult record_to(OutputFolder& out,
                        std::unique_ptr<hw::Link> link,
                        const BoardArguments& board,
                        const Scene& scene,
                        const RecordArguments& arguments,
                        Progress& progress) {
  warn_of_scan(scene, link == nullptr, progress);
  const fs::path partial = new_partial(out, arguments.replace, arguments.iq, progress);
  if (link) out.refuse_input(board.link.value, kRecordingName);
  out.check_space(least_bytes(board, scene, arguments));
  RecordResult result{.with_iq = arguments.iq};
  std::shared_ptr<IqFile> iq;
  if (arguments.iq) iq = std::make_shared<IqFile>(out.stage(kIqName), scene.plan());
  if (!link) {
    link = progress.step(
        "open", [&] { return make_simulated_link(scene, board, arguments.cache, iq, result); });
  }
  stop_in_order();
  RecordingSink sink(partial);
  hw::Recorder recorder(
      *link, [&](auto bytes) { sink.write(bytes); }, {.volumes = arguments.volumes});
  result.end = record(recorder, sink, iq.get(), arguments, progress);
  result.progress = recorder.progress();
  result.link = link->capabilities();
  const std::string loss = result.end == hw::RecordingEnd::lost ? link->loss() : "";
  if (!result.progress.configuration) {
    const bool is_ours = result.end == hw::RecordingEnd::stop_requested;
    const std::string why = is_ours        ? "interrupted before it sent a configuration"
                            : loss.empty() ? "sent no configuration"
                                           : loss;
    throw std::runtime_error("--board = " + arguments.board + ": " + why + "; nothing is recorded");
  }
  progress.warn(left_out_warning(board));
  if (result.progress.acquisitions > 1) {
    progress.warn("the recording holds " + std::to_string(result.progress.acquisitions) +
                  " acquisitions, one after the other (`wobblebench inspect` lists them); the "
                  "report is of the last");
  }
  const std::string report = record_report(result, result.scene.value_or(scene));
  // The other commands write their report.json into any folder.
  out.write_text(kReportName, report);
  const std::string summary = record_summary(result, out.directory());
  CommandResult done{.report = report,
                     .summary = summary,
                     .failure = {},
                     .adopted = AdoptedFile{partial, kRecordingName, "the recording"},
                     .document = record_document(result, summary)};
  if (result.end == hw::RecordingEnd::lost) {
    add_check({.group = "record",
               .name = "device",
               .failure = loss,
               .asked = "--board = " + arguments.board},
              done);
  }
  const hw::BoardAccount& account = result.progress.account;
  if (arguments.fail_on_loss) add_check(loss_check(account.lost.total(), account.emitted), done);
  return done;
}

int record_board(const RecordArguments& arguments) {
  const Scene scene = scene_of(arguments);
  const BoardArguments board = parse_board(arguments.board);
  if (arguments.iq) refuse_iq(scene, board);
  // What does not exist is refused before the folder is made; what takes long comes after it.
  auto link = is_simulated(board) ? nullptr : open_recorded_link(board);
  return run_in_folder(arguments.output, {}, [&](OutputFolder& out, Progress& progress) {
    return record_to(out, std::move(link), board, scene, arguments, progress);
  });
}

}  // namespace

Command add_record_command(CLI::App& app) {
  const auto arguments = std::make_shared<RecordArguments>();
  CLI::App& command = add_subcommand(app, "record", "Write what a board sends to recording.wbst");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
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
