// Volume after volume: acquisition and rendering overlapped; pictures, a video, latency.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/duration.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/picture/picture_warnings.h"
#include "bench/cli/stream/stream_page.h"
#include "bench/cli/stream/stream_report.h"
#include "bench/cli/stream/stream_sink.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/limits.h"
#include "bench/command/program.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/output/image_io.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/send/stream_sender.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "bench/pipeline/stream/stream.h"
#include "bench/pipeline/stream/stream_queues.h"
#include "bench/results/counts.h"
#include "bench/scene/scene_cost.h"
#include "bench/studies/latency/latency_spans_report.h"
#include "bench/studies/latency/service_times.h"
#include "hw/probe/acquisition_plan.h"
#include "render/gl/context.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

constexpr double kNotFormed = std::numeric_limits<double>::quiet_NaN();

constexpr const char* kNotSent = "none";

struct Arguments {
  const CLI::App* command = nullptr;
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim,pace=realtime";
  std::string gl = "auto";
  int volumes = 0;  ///< 0: to the end of the stream, or until Ctrl-C
  std::string policy = "newest";
  int queue = QueueOptions{}.volumes;
  int ring = hw::BoardOptions{}.ring_slots;
  std::string codec = "mjpg";
  std::string send = kNotSent;
  int errors = 8;
  std::vector<std::string> limits;
  bool trace = false;
  bool fail_on_loss = false;
};

QueueOptions queue_options(const Arguments& arguments) {
  const bool is_every = arguments.policy == to_string(StreamPolicy::every);
  return {.policy = is_every ? StreamPolicy::every : StreamPolicy::newest,
          .volumes = arguments.queue};
}

constexpr Codec kCodecs[] = {Codec::mjpg, Codec::mp4v, Codec::avc1};

/// None: no video.
std::optional<Codec> codec_of(const std::string& name) {
  for (const Codec codec : kCodecs) {
    if (name == to_string(codec)) return codec;
  }
  return {};
}

std::vector<std::string> codec_names() {
  std::vector<std::string> names;
  for (const Codec codec : kCodecs) names.emplace_back(to_string(codec));
  names.emplace_back("none");
  return names;
}

Scene scene_of(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  refuse_program(scene, "stream");
  if (!scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes > 0 ? arguments.volumes : hw::kMostVolumes;
  }
  return scene;
}

VolumeError error_of(const KeptDepth& kept,
                     const ResolvedScene& scene,
                     const sim::TissueMapSource& maps) {
  const Truth truth = true_surface(scene, maps, kept.volume);
  const DepthError error = measure_depth_error(kept.depth_m, truth, scene.view().camera);
  const auto first = scene.plan().stick_time(scene.plan().first_sequence(kept.volume));
  return {.volume = kept.volume,
          .time_s = 1e-3 * to_milliseconds(first.time_since_epoch()),
          .found = described(error)};
}

std::string why_no_errors(const Arguments& arguments, const ResolvedScene& scene) {
  if (!scene.subject()) return "what the samples are of is not known";
  if (arguments.errors == 0) return "--errors = 0";
  if (stop_requested()) return "stopped: they are measured after the stream";
  if (scene.render().pipeline.mid_volume) return "pictures show two volumes (mid_volume)";
  return "no whole volume was shown";
}

std::vector<ConditionalOption> conditional_options(const Arguments& arguments, bool is_measured) {
  const bool is_every = queue_options(arguments).policy == StreamPolicy::every;
  return {{"--queue", is_every, "--policy every"},
          {"--errors", is_measured, "samples of a known subject, and mid_volume = false"}};
}

std::string video_name(Codec codec) {
  return "stream" + std::string(extension(codec));
}

std::unique_ptr<Video> make_video(OutputFolder& out, std::optional<Codec> codec, int side) {
  if (!codec) return {};
  return std::make_unique<Video>(out.stage(video_name(*codec)), *codec, side, side);
}

/// Why there is no picture of a whole volume.
std::string why_nothing(const StreamResult& result, const Arguments& arguments) {
  if (!result.failure.empty()) return result.failure;
  if (stop_requested()) return "stopped before the first whole volume was shown";
  return "--board = " + arguments.board + ": no whole volume came";
}

/// What has to hold beside the limits.
std::vector<Check> checks_of(const StreamReport& report, const Arguments& arguments) {
  Check volumes{.group = "stream", .name = "volumes", .failure = report.result.failure};
  const std::uint64_t came = report.result.reader.volumes;
  const bool is_short = came < static_cast<std::uint64_t>(arguments.volumes);
  if (volumes.failure.empty() && is_short && !stop_requested()) {
    volumes.asked = "--volumes = " + std::to_string(arguments.volumes);
    volumes.failure = "--board " + arguments.board + " sent " + std::to_string(came);
  }
  if (!report.result.failure.empty()) volumes.asked = "--board = " + arguments.board;
  std::vector<Check> checks = {volumes};
  const hw::BoardAccount& account = report.result.reader.account;
  if (arguments.fail_on_loss) checks.push_back(loss_check(account.lost.total(), account.emitted));
  return checks;
}

StreamResult stream_to(StreamSink& sink,
                       const StreamSource& source,
                       render::Renderer& renderer,
                       const ResolvedScene& scene,
                       const Arguments& arguments,
                       StreamSender* sender,
                       Progress& progress) {
  const auto volumes = static_cast<std::size_t>(arguments.volumes);
  return progress.step("stream", [&](const PartDone& done) {
    std::uint64_t pictures = 0;
    const PictureSink show = [&](const ShownPicture& shown) {
      sink.take(shown);
      if (sender != nullptr) sender->take(shown);
      progress.note(std::to_string(++pictures) + " pictures, volume " +
                    std::to_string(shown.times.volume));
      if (volumes > 0) done(std::min<std::size_t>(shown.times.volume + 1, volumes), volumes);
    };
    StreamOptions options{.queue = queue_options(arguments),
                          .volumes = volumes,
                          .mid_volume = scene.render().pipeline.mid_volume};
    if (sender != nullptr) {
      options.frames = [sender](const StreamFrame& frame) { sender->add_frame(frame); };
    }
    GlStreamRenderer passes(renderer);
    return run_stream(source, passes, options, show, stop_requested);
  });
}

ExportedScan scan_to_send(const StreamSource& source, const ResolvedScene& scene) {
  const sim::SimulationOptions& simulation = scene.simulation();
  const hw::DisplayScale simulated{
      simulation.full_scale_db, simulation.dynamic_range_db, simulation.tgc_db_per_cm_mhz};
  return {.scene = scene,
          .display_scale = source.configuration ? source.configuration->display_scale : simulated,
          .simulated = scene.subject().has_value(),
          .knows_times = source.knows_times(),
          .labels = {}};
}

/// The port is said at once, so that clients can connect.
void begin_sending(StreamSender& sender, const ExportedScan& scan) {
  std::cerr << "wobblebench: sending by OpenIGTLink at " + sender.address() + "\n" << std::flush;
  sender.begin(scan);
}

/// What the last status message says.
std::string end_of(const StreamResult& result) {
  const hw::BoardAccount& account = result.reader.account;
  return "stream ends: " + std::to_string(result.shown.volumes) + " volumes shown, " +
         std::to_string(account.lost.total()) + " of " + std::to_string(account.emitted) +
         " sticks lost";
}

/// Delays of whole volumes by the card's model; nullopt: another board, or one that does not keep
/// time.
std::optional<CardDelays> card_delays_of(const Arguments& arguments, const ResolvedScene& scene) {
  const BoardArguments board = parse_board(arguments.board);
  if (!is_simulated(board) || scene.render().pipeline.mid_volume) return {};
  const auto options = read_link_options<sim::SimLinkOptions>(board);
  if (options.pace != hw::Pace::realtime) return {};
  return card_delays(scene.plan(), options.card);
}

StreamSummary summary_of(const StreamReport& report,
                         bool in_real_time,
                         const ResolvedScene& scene,
                         const Arguments& arguments) {
  const double sound_ms = to_milliseconds(scene.plan().volume_duration());
  const auto volumes = std::max<std::uint64_t>(report.result.reader.volumes, 1);
  const double simulated_ms = report.simulated ? report.simulated->volume_ms : 0;
  return summarize(report.result,
                   in_real_time ? sound_ms : 0,
                   simulated_ms / static_cast<double>(volumes),
                   card_delays_of(arguments, scene));
}

std::vector<VolumeError> errors_of(const StreamSink& sink,
                                   const ResolvedScene& scene,
                                   const sim::TissueMapSource& maps,
                                   Progress& progress) {
  std::vector<VolumeError> errors;
  if (!scene.subject() || sink.depths().empty()) return errors;
  progress.step("errors", [&](const PartDone& done) {
    PartCount parts(sink.depths().size(), done);
    for (const KeptDepth& kept : sink.depths()) {
      if (stop_requested()) break;
      errors.push_back(error_of(kept, scene, maps));
      parts.finish_one();
    }
  });
  return errors;
}

void write_pictures(StreamSink& sink,
                    std::optional<Codec> codec,
                    StreamReport& report,
                    bool with_trace,
                    OutputFolder& out) {
  write_png(out.stage("surface.png"), sink.last_picture()->surface, Values::light);
  if (with_trace) out.write_text("trace.json", stream_trace(report.result));
  if (const Video* video = sink.finish_video()) {
    report.video = VideoSummary{
        video_name(*codec), std::string(to_string(*codec)), video->backend(), video->seconds()};
  }
}

/// The largest magnitude over the measured volumes, NaN where a volume has none.
double worst(const std::vector<VolumeError>& errors, const Measure& figure) {
  double most = errors.empty() ? kNotFormed : 0;
  for (const VolumeError& error : errors) {
    const double value = std::abs(error.found.value(figure));
    most = std::isnan(value) ? value : std::max(most, value);
    if (std::isnan(most)) break;
  }
  return most;
}

/// Those that --limit takes: errors are of the worst measured volume. Of a report without errors
/// only the names are of use.
Measurements limited_figures(const StreamReport& report) {
  Measurements figures;
  figures.because(report.errors.empty() ? report.why_no_errors : "no surface is in view");
  for (const MeasuredValue& one : described(DepthError())) {
    if (one.measure->worse != Worse::neither) {
      figures.add(*one.measure, worst(report.errors, *one.measure));
    }
  }
  figures.because("fewer than two pictures were shown");
  describe(report.summary, figures);
  figures.because("");
  describe(report.result, figures);
  const hw::BoardAccount& account = report.result.reader.account;
  figures.add(
      counts::kLostPercent,
      100 * static_cast<double>(account.lost.total()) / static_cast<double>(account.emitted));
  return figures;
}

void warn_of_stream(const StreamResult& result,
                    const render::Picture& last,
                    const BoardConnection& board,
                    const ResolvedScene& scene,
                    Progress& progress) {
  progress.warn(board.left_out());
  warn_of_motor(result.reader.motor, scene.plan(), progress);
  warn_of_times(result.reader.off_plan_s, scene.plan(), scene.moves(), progress);
  for (const auto& warning : picture_warnings(last, scene, nullptr)) progress.warn(warning);
}

int stream(const Arguments& arguments) {
  const auto limits = parse_limits(arguments.limits, limit_names(limited_figures({})));
  const auto codec = codec_of(arguments.codec);
  const auto send = arguments.send == kNotSent ? std::optional<SendArguments>()
                                               : std::optional(parse_send(arguments.send));
  const Scene given = scene_of(arguments);
  check_memory_of_run(given, available_memory_bytes());
  BoardConnection board(parse_board(arguments.board), {.ring_slots = arguments.ring});
  const auto sender = send ? std::make_unique<StreamSender>(*send) : nullptr;
  const auto context = render::make_context(arguments.gl);

  return run_in_folder(arguments.output, {}, [&](OutputFolder& out, Progress& progress) {
    warn_of_software(*context, arguments.gl, progress);
    PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
    const ResolvedScene scene = board.resolve(given, cache, progress);
    const bool is_measured = scene.subject() && !scene.render().pipeline.mid_volume;
    progress.warn(
        idle_options_text(*arguments.command, conditional_options(arguments, is_measured)));
    StreamSink sink(scene.plan(),
                    make_video(out, codec, scene.render().ray_casting.image_size),
                    is_measured ? arguments.errors : 0);
    render::Renderer renderer(*context, scene.plan(), scene.render());
    progress.step("shaders", [&] { renderer.compile(); });
    const sim::TissueMapSource maps = kept_maps(cache.tissue_maps());
    const auto source =
        progress.step("scene", [&] { return board.connect(scene, maps, cache.echoes(scene)); });
    const ExportedScan scan = scan_to_send(source, scene);
    if (sender) begin_sending(*sender, scan);
    // Until here an interrupt ends the command at once, as there is nothing to keep.
    stop_in_order();

    StreamReport report;
    report.knows_times = scan.knows_times;
    report.queue = queue_options(arguments);
    report.result = stream_to(sink, source, renderer, scene, arguments, sender.get(), progress);
    if (sender) report.sent = sender->finish(end_of(report.result));
    if (!sink.last_picture()) throw std::runtime_error(why_nothing(report.result, arguments));
    warn_of_stream(report.result, *sink.last_picture(), board, scene, progress);
    report.simulated = board.simulated();
    const bool in_real_time = !report.result.link.waits_for_reader || source.board.epoch();
    report.summary = summary_of(report, in_real_time, scene, arguments);
    report.errors = errors_of(sink, scene, maps, progress);
    if (report.errors.empty()) report.why_no_errors = why_no_errors(arguments, scene);
    progress.step("write", [&] { write_pictures(sink, codec, report, arguments.trace, out); });

    Provenance provenance = provenance_of_simulation(*context, scene.simulation().seed);
    provenance.board = hw::to_string(report.result.link.origin);
    CommandResult done{
        .report = stream_report(report, std::move(provenance), scene, progress.times()),
        .summary = stream_text(report, out.directory()),
        .failure = {},
        .document = stream_document(report, scene)};
    for (Check& check : checks_of(report, arguments)) add_check(std::move(check), done);
    check_limits(limits, limited_figures(report), done);
    return done;
  });
}

}  // namespace

Command add_stream_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "stream", "Volume after volume, acquired and rendered at once: a video, and latency");
  arguments->command = &command;
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output, arguments->cache);
  add_limit_option(command, arguments->limits, limit_names(limited_figures({})));
  add_junit_option(command, arguments->output);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  add_optional_integer(command,
                       "--volumes",
                       arguments->volumes,
                       "Stop after so many; without it at the end of the stream, or at Ctrl-C",
                       1,
                       hw::kMostVolumes);
  add_choice(
      command,
      "--policy",
      arguments->policy,
      {"newest", "every"},
      "newest: drop volumes that a later one has overtaken; every: they wait, and so does the "
      "board");
  add_integer(command, "--queue", arguments->queue, "every: volumes that may wait", 1, 64);
  add_integer(
      command, "--ring", arguments->ring, "Sticks that the board holds", 1, hw::kMaxRingSlots);
  add_choice(command,
             "--codec",
             arguments->codec,
             codec_names(),
             "Of the video: mjpg (.avi), mp4v or avc1 (.mp4), or none");
  add_text(command,
           "--send",
           arguments->send,
           "Send it by OpenIGTLink while it runs: igtl=PORT or igtl=HOST:PORT, then ,key=value …");
  add_integer(command,
              "--errors",
              arguments->errors,
              "Volumes whose depth error is measured after the stream, spread over it",
              0,
              64);
  add_flag(command, "--trace", arguments->trace, "Write trace.json, which Perfetto opens");
  add_flag(command,
           "--fail-on-loss",
           arguments->fail_on_loss,
           "Exit code 1 if sticks were lost; results are written all the same");
  return {&command, [arguments] { return stream(*arguments); }};
}

}  // namespace wobblebench::bench
