// Volume after volume: acquisition and rendering overlapped; pictures, a video, latency.
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "base/user_error.h"
#include "bench/cache/kept_maps.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/commands.h"
#include "bench/cli/common_options.h"
#include "bench/cli/stop_signals.h"
#include "bench/evaluation/measures/depth_error.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "bench/pipeline/stream/kept_depths.h"
#include "bench/pipeline/stream/stream.h"
#include "bench/report/output/image_io.h"
#include "bench/report/output/output_folder.h"
#include "bench/report/output/progress.h"
#include "bench/report/output/video.h"
#include "bench/report/stream/stream_report.h"
#include "bench/scene/available_memory.h"
#include "bench/scene/scene_cost.h"
#include "render/gl/context.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

/// So that a stream of hours makes no file that players refuse.
constexpr double kLongestVideo_s = 1200;

struct Arguments {
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string board = "sim,pace=realtime";
  std::string gl = "auto";
  int volumes = 0;  ///< 0: to the end of the stream, or until Ctrl-C
  std::string policy = "newest";
  int queue = QueueOptions{}.volumes;
  std::string codec = "mjpg";
  int errors = 8;
  bool trace = false;
};

QueueOptions queue_options(const Arguments& arguments) {
  if (arguments.policy != "newest" && arguments.policy != "every") {
    throw UserError("--policy = " + arguments.policy + ": must be newest or every");
  }
  return {.policy = arguments.policy == "every" ? StreamPolicy::every : StreamPolicy::newest,
          .volumes = arguments.queue};
}

/// None: no video.
std::optional<Codec> codec_of(const std::string& name) {
  if (name == "none") return {};
  for (const Codec codec : {Codec::mjpg, Codec::mp4v, Codec::avc1}) {
    if (name == to_string(codec)) return codec;
  }
  throw UserError("--codec = " + name + ": must be mjpg, mp4v, avc1 or none");
}

Scene scene_of(const Arguments& arguments) {
  Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  if (!scene.picture.correction.empty()) {
    throw UserError("render.correction = " + scene.picture.correction +
                    ": must be empty; `stream` corrects no pictures, `run` does");
  }
  if (!scene.given.contains("acquisition.volumes")) {
    scene.acquisition.volumes = arguments.volumes > 0 ? arguments.volumes : hw::kMostVolumes;
  }
  return scene;
}

/// Writes pictures on the stream's writing thread.
class Sink {
 public:
  Sink(const hw::AcquisitionPlan& plan, std::unique_ptr<Video> video, int most_depths)
      : plan_(plan), video_(std::move(video)), depths_(most_depths) {}

  void take(const ShownPicture& shown) {
    const auto& times = shown.times;
    if (first_ == 0 && last_ == 0) first_ = times.volume;
    if (video_ && time_s(times) < kLongestVideo_s)
      video_->add(shown.picture.surface, time_s(times));
    last_ = times.volume;
    if (!times.whole) return;
    depths_.add(times.volume, shown.picture.depth_m);
    picture_ = shown.picture;
  }

  /// Shows the last picture for the time of one volume.
  void finish_video() {
    const double period_s = 1e-3 * hw::to_milliseconds(plan_.volume_duration());
    if (video_) video_->finish(std::min(kLongestVideo_s, (last_ - first_ + 1) * period_s));
  }
  const Video* video() const { return video_.get(); }
  const std::optional<render::Picture>& last_picture() const { return picture_; }
  const std::vector<KeptDepth>& depths() const { return depths_.kept(); }

 private:
  /// Of the picture's newest stick after the first picture's volume began, on the device's clock.
  double time_s(const PictureTimes& times) const {
    const auto frame = std::max(times.sticks + times.lost - 1, 0);
    const auto newest =
        plan_.stick_time(plan_.first_sequence(times.volume) + static_cast<std::uint64_t>(frame));
    const auto begin = plan_.stick_time(plan_.first_sequence(first_));
    return times.whole
               ? (times.volume - first_) * 1e-3 * hw::to_milliseconds(plan_.volume_duration())
               : 1e-3 * hw::to_milliseconds(newest - begin);
  }

  const hw::AcquisitionPlan plan_;
  std::unique_ptr<Video> video_;
  KeptDepths depths_;
  std::optional<render::Picture> picture_;  ///< the last of a whole volume
  std::uint32_t first_ = 0, last_ = 0;
};

VolumeError error_of(const KeptDepth& kept,
                     const phantoms::PlacedPhantom& subject,
                     const Scene& scene,
                     const sim::TissueMapSource& maps) {
  const auto plan = scene.plan();
  const auto view = render::make_view(scene.render);
  Truth truth = trace_truth(subject, plan, view, kept.volume);
  mark_shadowed(truth, StickReach(subject, plan, scene.simulation, maps, kept.volume), view.camera);
  const DepthError error = measure_depth_error(kept.depth_m, truth, view.camera);
  const auto first = plan.stick_time(plan.first_sequence(kept.volume));
  return {.volume = kept.volume,
          .time_s = 1e-3 * hw::to_milliseconds(first.time_since_epoch()),
          .depth = error.depth,
          .missed_percent = error.missed_percent(),
          .false_percent = error.false_percent()};
}

std::string why_no_errors(const Arguments& arguments, const Scene& scene, bool known) {
  if (!known) return "what the samples are of is not known";
  if (arguments.errors == 0) return "--errors = 0";
  if (scene.render.pipeline.mid_volume) return "pictures show two volumes (mid_volume)";
  return "no whole volume was shown";
}

std::unique_ptr<Video> make_video(OutputFolder& out, std::optional<Codec> codec, int side) {
  if (!codec) return {};
  return std::make_unique<Video>(
      out.stage("stream" + std::string(extension(*codec))), *codec, side, side);
}

int verdict(const StreamReport& report, const Arguments& arguments) {
  std::string why = report.result.failure;
  if (why.empty() && report.result.shown.volumes == 0) {
    why = "--board = " + arguments.board + ": no whole volume came";
  }
  if (why.empty() && arguments.volumes > 0 && !stop_requested() &&
      report.result.reader.volumes < static_cast<std::uint64_t>(arguments.volumes)) {
    why = "--volumes = " + std::to_string(arguments.volumes) + ": --board " + arguments.board +
          " sent " + std::to_string(report.result.reader.volumes);
  }
  if (why.empty()) return 0;
  std::cerr << "wobblebench: " << why << "\n";
  return 1;
}

int stream(const Arguments& arguments) {
  const QueueOptions queue = queue_options(arguments);
  const auto codec = codec_of(arguments.codec);
  Scene scene = scene_of(arguments);
  check_memory_of_run(scene, available_memory_bytes());
  BoardConnection board(parse_board(arguments.board));
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.output.folder);
  Progress progress;

  const bool known = board.adopt_plan(scene) == hw::StreamOrigin::simulated;
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  std::optional<phantoms::PlacedPhantom> subject;
  if (known) {
    const auto phantom = progress.step("phantom", [&] { return cache.phantom(scene.phantom); });
    complete_from_phantom(scene, phantom);
    subject = scene.place(phantom);
  } else {
    complete_from_plan(scene);
  }
  const auto plan = scene.plan();
  const bool mid_volume = scene.render.pipeline.mid_volume;
  Sink sink(plan,
            make_video(out, codec, scene.render.ray_casting.image_size),
            mid_volume || !known ? 0 : arguments.errors);
  render::Renderer renderer(*context, plan, scene.render);
  progress.step("shaders", [&] { renderer.compile(); });
  const sim::TissueMapSource maps = kept_maps(cache.tissue_maps());
  stop_in_order();
  hw::Board& source = *progress.step(
      "scene", [&] { return subject ? &board.connect(scene, *subject, maps) : &board.connect(); });

  StreamReport report{.result = {}, .summary = {}, .queue = queue};
  report.result = progress.step("stream", [&](const PartDone& done) {
    std::uint64_t pictures = 0;
    const PictureSink show = [&](const ShownPicture& shown) {
      sink.take(shown);
      progress.note(std::to_string(++pictures) + " pictures, volume " +
                    std::to_string(shown.times.volume));
      if (arguments.volumes > 0) {
        done(std::min<std::size_t>(shown.times.volume + 1, std::size_t(arguments.volumes)),
             std::size_t(arguments.volumes));
      }
    };
    const StreamOptions options{.queue = queue,
                                .volumes = static_cast<std::uint64_t>(arguments.volumes),
                                .mid_volume = mid_volume};
    GlStreamRenderer passes(renderer);
    return run_stream(source, plan, passes, options, arguments.board, show, stop_requested);
  });
  report.simulated = board.simulated();
  const bool in_real_time = !report.result.link.waits_for_reader || source.epoch();
  const double sound_ms = hw::to_milliseconds(plan.volume_duration());
  const double simulated_ms = report.simulated ? report.simulated->volume_ms : 0;
  report.summary = summarize(
      report.result,
      in_real_time ? sound_ms : 0,
      simulated_ms / static_cast<double>(std::max<std::uint64_t>(report.result.reader.volumes, 1)));
  progress.step("errors", [&](const PartDone& done) {
    PartCount parts(sink.depths().size(), done);
    for (const KeptDepth& kept : sink.depths()) {
      if (!subject || stop_requested()) break;
      report.errors.push_back(error_of(kept, *subject, scene, maps));
      parts.finish_one();
    }
  });
  if (report.errors.empty()) report.why_no_errors = why_no_errors(arguments, scene, known);

  progress.step("write", [&] {
    if (const auto& picture = sink.last_picture()) {
      write_png(out.stage("surface.png"), picture->surface, Values::light);
      sink.finish_video();
    }
    if (arguments.trace) out.write_text("trace.json", stream_trace(report.result));
  });
  if (const Video* video = sink.video()) {
    report.video = VideoSummary{"stream" + std::string(extension(*codec)),
                                std::string(to_string(*codec)),
                                video->backend(),
                                video->seconds()};
  }
  Provenance provenance = provenance_of_simulation(*context, scene.simulation.seed);
  provenance.board = hw::to_string(report.result.link.origin);
  const std::string json = stream_report(report, std::move(provenance), scene, progress.times());
  out.write_text("report.json", json);
  out.commit();
  std::cout << (arguments.output.json ? json : stream_text(report, out.directory()));
  return verdict(report, arguments);
}

}  // namespace

Command add_stream_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "stream", "Volume after volume, acquired and rendered at once: a video, and latency");
  add_scene_options(command, arguments->scene);
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  add_board_option(command, arguments->board);
  add_gl_option(command, arguments->gl);
  add_optional_integer(command,
                       "--volumes",
                       arguments->volumes,
                       "Stop after so many; without it at the end of the stream, or at Ctrl-C",
                       1,
                       hw::kMostVolumes);
  add_text(command,
           "--policy",
           arguments->policy,
           "newest: drop volumes that a later one has overtaken; every: they wait, and so does the "
           "board");
  add_integer(command, "--queue", arguments->queue, "every: volumes that may wait", 1, 64);
  add_text(command,
           "--codec",
           arguments->codec,
           "Of the video: mjpg (.avi), mp4v or avc1 (.mp4), or none");
  add_integer(command,
              "--errors",
              arguments->errors,
              "Volumes whose depth error is measured after the stream, spread over it",
              0,
              64);
  add_flag(command, "--trace", arguments->trace, "Write trace.json, which Perfetto opens");
  return {&command, [arguments] { return stream(*arguments); }};
}

}  // namespace wobblebench::bench
