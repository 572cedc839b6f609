// Writes a scan in the formats of other programs.
#include <algorithm>
#include <deque>
#include <filesystem>
#include <iostream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <utility>

#include "base/file.h"
#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/exchange/export/writers.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/pipeline/acquire.h"
#include "bench/pipeline/motor_warning.h"
#include "bench/pipeline/stream/gl_stream_renderer.h"
#include "bench/scene/reported_run.h"
#include "bench/scene/scene_cost.h"
#include "hw/link/link_arguments.h"
#include "render/gl/context.h"
#include "render/renderer.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string from;
  std::vector<std::string> to;
  SceneArguments scene;
  CacheArguments cache;
  std::string gl = "auto";
  int volumes = 0;  ///< 0: all that the scene has, one of a recording
  bool replace = false;
};

/// One --to, parsed.
struct FileRequest {
  std::string text;  ///< as given
  fs::path path;
  FileOptions options;
  std::vector<std::string> given;  ///< keys
};

FileRequest parse_request(const std::string& text) {
  try {
    const hw::LinkArguments parsed = hw::parse_link_arguments("to=" + text);
    FileRequest request{.text = text, .path = parsed.value, .options = {}, .given = {}};
    hw::LinkSettings settings(parsed);
    settings.read(request.options);
    settings.finish("--to");
    for (const auto& [key, unused] : parsed.settings) request.given.push_back(key);
    export_format(request.path.filename().string());
    return request;
  } catch (const InvalidOption& error) {
    throw UserError("--to = " + text + ": " + error.what());
  }
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

std::vector<FileRequest> parse_requests(const Arguments& arguments) {
  if (arguments.to.empty()) throw UserError("--to: is missing; must be --to FILE.npz, say");
  std::vector<FileRequest> requests;
  std::set<fs::path> names;
  for (const std::string& text : arguments.to) {
    requests.push_back(parse_request(text));
    const fs::path& path = requests.back().path;
    if (folder_of(path) != folder_of(requests.front().path)) {
      throw UserError("--to = " + text + ": must lie in one folder with " +
                      requests.front().path.string());
    }
    if (!names.insert(path.filename()).second)
      throw UserError("--to = " + text + ": is given twice");
    if (!arguments.replace && fs::exists(fs::symlink_status(path))) {
      throw UserError("--to = " + text + ": exists; must be a new file, or give --replace");
    }
  }
  return requests;
}

/// What is exported: the board that sticks come from, and the scene.
struct Source {
  std::string board;
  Scene scene;
};

/// The board and the scene of a run's folder. Its volume and its picture are made again.
Source source_of_run(const Arguments& arguments) {
  const fs::path file = fs::path(arguments.from) / "report.json";
  const auto refuse = [&](const std::string& why) { throw UserError(file.string() + ": " + why); };
  if (!fs::is_regular_file(file)) refuse("is missing; FROM must be a folder of `wobblebench run`");
  const auto report = nlohmann::ordered_json::parse(read_file(file), nullptr, false);
  if (!report.is_object() || report.value("command", "") != "run" || !report.contains("scene")) {
    refuse("is no report of `wobblebench run`");
  }
  return {simulated_board_of(report, file.string()),
          load_resolved_scene(report["scene"], arguments.scene.settings, file.string())};
}

Source source_of(const Arguments& arguments) {
  const fs::path from = arguments.from;
  const bool has_scene = !arguments.scene.file.empty();
  const bool is_board = arguments.from.find('=') != std::string::npos && !fs::exists(from);
  const bool is_scene =
      ((from.extension() == ".toml" || from.extension() == ".json") && !is_board) ||
      arguments.from == "sim";
  const bool is_run = !is_scene && fs::is_directory(from);
  if (has_scene && (is_scene || is_run)) {
    throw UserError("--scene: acts with a recording; FROM = " + arguments.from + " is a scene");
  }
  if (is_run) return source_of_run(arguments);
  if (is_scene) {
    return {"sim",
            load_scene(arguments.from == "sim" ? fs::path() : from, arguments.scene.settings)};
  }
  const auto& settings = arguments.scene.settings;
  const std::string board = is_board ? arguments.from : "file=" + arguments.from;
  const fs::path beside = fs::path(from).replace_extension(".json");
  if (has_scene || from.extension() != ".wbst" || !fs::exists(beside)) {
    return {board, load_scene(arguments.scene.file, settings)};
  }
  const auto report = nlohmann::ordered_json::parse(read_file(beside), nullptr, false);
  // Of a subject that is not known it says no more than the recording, which need not know its
  // aperture.
  const auto phantom = nlohmann::ordered_json::json_pointer("/scene/phantom");
  if (!report.is_object() || !report.contains(phantom) || report[phantom].is_null()) {
    return {board, load_scene({}, settings)};
  }
  return {board, load_resolved_scene(report["scene"], settings, beside.string())};
}

/// Hands volumes to the writers, and the last one to the renderer.
class ExportingRenderer : public StreamRenderer {
 public:
  /// `passes`: null where no picture is needed.
  ExportingRenderer(const hw::AcquisitionPlan& plan, StreamRenderer* passes, std::uint64_t volumes)
      : plan_(plan), passes_(passes), volumes_(volumes) {}

  double add_frame(int frame, const hw::PolarFrame& samples) override {
    frames_.emplace_back(frame, samples);
    return passes_ != nullptr ? passes_->add_frame(frame, samples) : 0;
  }
  render::Picture render() override {
    {
      const std::lock_guard lock(mutex_);
      waiting_.push_back(std::exchange(frames_, {}));
    }
    const bool is_last = ++rendered_ == volumes_;
    return is_last && passes_ != nullptr ? passes_->render() : render::Picture();
  }

  /// The next volume, on the sink's thread.
  hw::PolarVolume take(std::uint32_t index) {
    const std::lock_guard lock(mutex_);
    hw::PolarVolume volume(plan_, index);
    for (const auto& [frame, samples] : waiting_.front()) {
      volume.place_frame(frame, samples, hw::SampleScale::log_compressed);
    }
    waiting_.pop_front();
    return volume;
  }

 private:
  using Frames = std::vector<std::pair<int, hw::PolarFrame>>;

  hw::AcquisitionPlan plan_;
  StreamRenderer* passes_;
  std::uint64_t volumes_;
  std::uint64_t rendered_ = 0;
  Frames frames_;
  std::mutex mutex_;
  std::deque<Frames> waiting_;
};

/// What came, as far as a user should know it.
struct Exported {
  std::uint32_t last_volume = 0;
  int missing_sticks = 0;
  std::uint64_t clamped = 0;  ///< samples
  hw::MotorDeviation motor;
  render::Picture picture;
};

Exported stream_to(const std::vector<std::unique_ptr<ScanWriter>>& writers,
                   const StreamSource& source,
                   StreamRenderer* passes,
                   std::uint32_t volumes,
                   const PartDone& done) {
  ExportingRenderer renderer(source.plan, passes, volumes);
  Exported exported;
  std::uint32_t written = 0;
  const auto write = [&](const ShownPicture& shown) {
    const hw::PolarVolume volume = renderer.take(shown.times.volume);
    for (const auto& writer : writers) writer->add(volume);
    exported.last_volume = volume.volume_index();
    exported.missing_sticks += volume.missing_sticks();
    exported.motor.add(hw::motor_deviation(volume));
    exported.picture = shown.picture;
    done(++written, volumes);
  };
  StreamOptions options{.queue = {.policy = StreamPolicy::every}, .volumes = volumes};
  const StreamResult result = run_stream(source, renderer, options, write, [] { return false; });
  if (!result.failure.empty()) throw std::runtime_error(source.name + ": " + result.failure);
  exported.clamped = result.reader.clamped;
  if (written == volumes) return exported;
  throw UserError("--volumes = " + std::to_string(volumes) + ": " + source.name + " has " +
                  std::to_string(written));
}

hw::DisplayScale display_scale(const StreamSource& source, const Scene& scene) {
  if (source.configuration) return source.configuration->display_scale;
  return {scene.simulation.full_scale_db,
          scene.simulation.dynamic_range_db,
          scene.simulation.tgc_db_per_cm_mhz};
}

/// Options of each file, checked against what is known.
std::vector<FileOptions> chosen(const std::vector<FileRequest>& requests,
                                const hw::AcquisitionPlan& plan,
                                std::uint32_t volumes,
                                bool is_known) {
  std::vector<FileOptions> options;
  for (const FileRequest& request : requests) {
    const std::string name = request.path.string();
    options.push_back(chosen_options(name, request.options, request.given, volumes, is_known));
    check_grid(name, options.back(), plan);
    check_motor(name, options.back(), plan);
  }
  return options;
}

std::string summary(const std::vector<FileRequest>& requests,
                    const ExportedScan& scan,
                    const Exported& exported) {
  std::ostringstream text;
  const auto& plan = scan.plan().acquisition();
  text << "scan        " << scan.volumes << (scan.volumes == 1 ? " volume" : " volumes") << " of "
       << plan.frames_per_volume << " frames of " << plan.sticks_per_frame << " sticks of "
       << plan.samples_per_stick << " samples, "
       << (scan.simulated ? "simulated" : "a recording of hardware: its truth is not known")
       << "\n";
  if (exported.clamped > 0) {
    text << "samples     " << exported.clamped << " out of range and clamped\n";
  }
  for (const FileRequest& request : requests) {
    text << "results     " << request.path.string() << ", "
         << significant(static_cast<double>(fs::file_size(request.path)) / 1e6, 4) << " MB\n";
  }
  return text.str();
}

/// Empty: all are there.
std::string missing_text(int sticks) {
  if (sticks == 0) return "";
  return std::to_string(sticks) +
         (sticks == 1 ? " stick was lost: its" : " sticks were lost: their") +
         " samples are 0 in the files; only .npz says so (`arrived`), of others they are read as "
         "black echoes";
}

std::optional<Truth> truth_of(const ResolvedScene& scene,
                              const sim::TissueMapSource& maps,
                              const Exported& exported) {
  if (!scene.subject()) return {};
  Truth truth = true_surface(scene, maps, exported.last_volume);
  if (exported.motor.matters(scene.plan())) {
    mark_outside(truth, exported.motor, scene.plan().geometry(), scene.view().camera);
  }
  return truth;
}

/// The renderer, where a file needs its picture.
struct Passes {
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  std::unique_ptr<GlStreamRenderer> stream;
  render::VolumeSlices slices;  ///< where they are kept

  Passes(const std::string& gl, const ResolvedScene& scene, bool keeps_slices)
      : context(render::make_context(gl)),
        renderer(std::make_unique<render::Renderer>(*context, scene.plan(), scene.render())),
        stream(std::make_unique<GlStreamRenderer>(*renderer)) {
    if (!keeps_slices) return;
    render::RenderTaps taps;
    taps.slices = [this](const render::VolumeSlices& made) { slices = made; };
    renderer->set_taps(taps);
  }
  Passes(const Passes&) = delete;
  Passes& operator=(const Passes&) = delete;
};

std::vector<PlannedStep> planned_steps() {
  return {{"phantom", 40}, {"scene", 5}, {"stream", 30}, {"truth", 3}, {"write", 2}};
}

int export_scan(const Arguments& arguments) {
  const auto requests = parse_requests(arguments);
  Source source = source_of(arguments);
  const BoardArguments board_arguments = parse_board(source.board);
  const bool simulated = is_simulated(board_arguments);
  if (simulated && arguments.volumes > 0) source.scene.acquisition.volumes = arguments.volumes;
  const auto volumes = static_cast<std::uint32_t>(simulated ? source.scene.acquisition.volumes
                                                            : std::max(1, arguments.volumes));
  if (simulated) {
    chosen(requests, source.scene.plan(), volumes, true);
    check_memory_of_run(source.scene, available_memory_bytes());
  }
  BoardConnection board(board_arguments);
  OutputFolder out(folder_of(requests.front().path), "--to in");
  Progress progress(planned_steps());
  progress.warn(out.warning());
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  const ResolvedScene scene = board.resolve(source.scene, cache, progress);
  const auto options = chosen(requests, scene.plan(), volumes, scene.subject().has_value());
  const bool needs_passes =
      std::ranges::any_of(options, [](const auto& one) { return needs_picture(one.content); });
  const bool keeps_slices =
      std::ranges::any_of(options, [](const auto& one) { return one.content == Content::slices; });
  const auto passes =
      needs_passes ? std::make_unique<Passes>(arguments.gl, scene, keeps_slices) : nullptr;
  const sim::TissueMapSource maps = kept_maps(cache.tissue_maps());
  const StreamSource stream = progress.step("scene", [&] { return board.connect(scene, maps); });
  ExportedScan scan{.scene = scene,
                    .display_scale = display_scale(stream, scene.options()),
                    .simulated = scene.subject().has_value(),
                    .knows_times = stream.knows_times(),
                    .volumes = volumes,
                    .labels = {}};
  if (scene.subject()) scan.labels.emplace(scene, maps);
  std::vector<std::unique_ptr<ScanWriter>> writers;
  for (std::size_t i = 0; i < requests.size(); ++i) {
    const std::string name = requests[i].path.filename().string();
    writers.push_back(make_writer(export_format(name), out.stage(name), options[i], scan));
  }
  const Exported exported = progress.step("stream", [&](const PartDone& done) {
    return stream_to(writers, stream, passes ? passes->stream.get() : nullptr, volumes, done);
  });
  progress.warn(board.left_out());
  progress.warn(missing_text(exported.missing_sticks));
  warn_of_motor(exported.motor, scene.plan(), progress);
  std::optional<ExportedPicture> picture;
  if (passes) {
    auto truth = progress.step("truth", [&] { return truth_of(scene, maps, exported); });
    picture.emplace(ExportedPicture{exported.picture, passes->slices, std::move(truth)});
  }
  progress.step("write", [&] {
    for (const auto& writer : writers) writer->finish(picture ? &*picture : nullptr);
  });
  out.commit();
  std::cout << summary(requests, scan, exported);
  return kDone;
}

}  // namespace

Command add_export_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "export", "Write a scan for other programs: NumPy, 3D Slicer, ITK, PLUS");
  add_text(command,
           "FROM",
           arguments->from,
           "A scene (.toml, or sim for the defaults), a recording, a board as --board takes it, or "
           "the folder of a run");
  add_list(
      command,
      "--to",
      arguments->to,
      "File to write (repeatable): .npz, .nrrd, .seq.nrrd, .mha, .hdf5, .vol, .dcm or .ply, then "
      ",content=C,type=T,spacing_mm=S");
  add_path(
      command,
      "--scene",
      arguments->scene.file,
      "Scene of a recording, with the phantom that it is of; default: recording.json beside it");
  add_list(command,
           "--set",
           arguments->scene.settings,
           "Override one option: section.key=value (repeatable)");
  add_optional_integer(command,
                       "--volumes",
                       arguments->volumes,
                       "Volumes to export (default: those of the scene; one of a recording)",
                       1,
                       hw::kMostVolumes);
  add_flag(command, "--replace", arguments->replace, "Replace files that exist");
  add_cache_options(command, arguments->cache);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return export_scan(*arguments); }};
}

}  // namespace wobblebench::bench
