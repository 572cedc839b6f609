// The surface that another program found in a scene, compared with the truth.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "base/file.h"
#include "base/number_text.h"
#include "base/units.h"
#include "base/user_error.h"
#include "bench/cache/phantom_cache.h"
#include "bench/cli/picture/picture_limits.h"
#include "bench/cli/picture/picture_report.h"
#include "bench/cli/run/run_page.h"
#include "bench/cli/run/run_pictures.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/limits.h"
#include "bench/command/run_in_folder.h"
#include "bench/evaluation/truth/shadows.h"
#include "bench/exchange/surface/found_surface.h"
#include "bench/output/camera_matrices.h"
#include "bench/output/error_report.h"
#include "bench/output/report.h"
#include "bench/scene/reported_run.h"
#include "render/reference/reference.h"

namespace wobblebench::bench {

namespace {

struct ScoreArguments {
  const CLI::App* command = nullptr;
  SurfaceFileOptions surface;
  SceneArguments scene;
  CacheArguments cache;
  OutputArguments output;
  std::string unit = "auto", kind = "ray", frame = "probe", far, point_mm, step_mm;
  int volume = 0;
  bool clip = false;
  std::vector<std::string> limits;
};

/// A scene to be scored in, and which of its volumes.
struct ScoredScene {
  Scene options;
  std::uint32_t volume = 0;
  Json camera = nullptr;  ///< as the scene's report has it; null: not known
};

UserError no_report(const std::filesystem::path& file, const std::string& why) {
  return UserError("--scene = " + file.string() + ": " + why +
                   "; must be report.json of `run`, or a scene in TOML");
}

ScoredScene scene_of_report(const SceneArguments& arguments, const Json& report) {
  const std::filesystem::path& file = arguments.file;
  if (!report["scene"].is_object()) throw no_report(file, "has no \"scene\"");
  if (!report["scene"].contains("phantom") || report["scene"]["phantom"].is_null()) {
    throw no_report(file, "is of samples whose subject is not known: there is no truth");
  }
  ScoredScene scored{
      load_resolved_scene(report["scene"], arguments.settings, "--scene = " + file.string())};
  scored.volume = volume_of(report, "--scene = " + file.string());
  if (arguments.settings.empty()) scored.camera = report["camera"];
  return scored;
}

/// A report knows its volume; a scene that moves does not.
void take_volume(ScoredScene& scored, const ScoreArguments& arguments, bool is_report) {
  if (arguments.command->get_option("--volume")->count() == 0) {
    if (is_report || !scored.options.moves()) return;
    throw UserError("--volume: is missing: " + arguments.scene.file.string() + " moves");
  }
  const auto asked = static_cast<std::uint32_t>(arguments.volume);
  if (is_report && scored.volume != asked) {
    throw UserError("--volume = " + std::to_string(asked) + ": " + arguments.scene.file.string() +
                    " is of volume " + std::to_string(scored.volume) + "; leave it out");
  }
  scored.volume = asked;
}

/// With the settings of passes 3 and 4 alone: no volume is rendered.
ScoredScene load_scored_scene(const ScoreArguments& arguments) {
  const SceneArguments& scene = arguments.scene;
  Json report;
  if (scene.file.extension() == ".json") {
    report = Json::parse(read_file(scene.file), nullptr, false);
  }
  // A report without a picture, as recording.json, has a scene as a file of TOML has one.
  const bool is_report =
      report.is_object() && report.contains("scene") && report["camera"].is_object();
  ScoredScene scored = is_report ? scene_of_report(scene, report)
                                 : ScoredScene{load_scene(scene.file, scene.settings)};
  take_volume(scored, arguments, is_report);
  scored.options.render.ray_casting.mode = render::RenderMode::surface;
  return scored;
}

/// The view must be the one that the report's pictures were made in, or its truth is another.
void check_camera(const ScoredScene& scored, const render::Camera& camera) {
  if (scored.camera.is_null()) return;
  constexpr double kAllowed = 1e-6;  // of the twelve digits of the report's options
  const auto matrix = [](const Json& from) {
    return from.value("world_to_ndc", Json::array()).flatten();
  };
  const Json theirs = matrix(scored.camera), ours = matrix(camera_json(camera));
  bool same = theirs.size() == ours.size();
  for (const auto& [place, value] : ours.items()) {
    same = same && theirs[place].is_number() &&
           std::abs(theirs[place].get<double>() - value.get<double>()) <= kAllowed;
  }
  if (same) return;
  throw UserError(
      "--scene: its camera is not the one that this program makes of its options: it was written "
      "by another version");
}

/// A number above 0; nullopt for "".
std::optional<double> positive_number(const std::string& option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc() && stop == text.data() + text.size() && std::isfinite(value) &&
      value > 0) {
    return value;
  }
  throw UserError(option + " = " + text + ": must be a number above 0");
}

SurfaceFileOptions surface_options(const ScoreArguments& arguments) {
  const auto given = [&](const char* option, const std::string& value) {
    return arguments.command->get_option(option)->count() > 0 ? value : std::string();
  };
  SurfaceFileOptions options = arguments.surface;
  options.unit = arguments.unit == "auto" ? "" : arguments.unit;
  options.kind = given("--kind", arguments.kind);
  options.frame = given("--frame", arguments.frame);
  options.far = positive_number("--far", arguments.far);
  options.point_m = positive_number("--point-mm", arguments.point_mm).value_or(0) * kMillimetre;
  options.step_m = positive_number("--step-mm", arguments.step_mm).value_or(0) * kMillimetre;
  return options;
}

std::vector<ConditionalOption> conditional_options(SurfaceFileKind kind) {
  const bool is_map = kind == SurfaceFileKind::depth_map;
  const char *map = "a depth map", *points = "a point cloud";
  return {{"--kind", is_map, map},
          {"--clip", is_map, map},
          {"--channel", is_map, map},
          {"--mask", is_map, map},
          {"--far", is_map, map},
          {"--step-mm", is_map, map},
          {"--frame", !is_map, "a mesh or a point cloud"},
          {"--point-mm", kind == SurfaceFileKind::points, points}};
}

/// Counts the pixels whose depth lies before or behind the volume of interest, where no truth is,
/// and with `clip` leaves them out. Returns a warning where they are many and stay.
std::string count_outside_box(FoundSurface& found, const ResolvedScene& scene, bool clip) {
  constexpr double kRounding_m = 1e-6, kMany = 0.05;
  const auto& box = scene.render().volume_of_interest;
  int outside = 0, all = 0;
  double nearest_m = kNoSurface, farthest_m = kNoSurface;
  for (int row = 0; row < found.depth_m.height; ++row) {
    for (int column = 0; column < found.depth_m.width; ++column) {
      float& z_m = found.depth_m.at(column, row);
      if (!std::isfinite(z_m)) continue;
      ++all;
      const render::Span span = render::clip_to_box(scene.view().camera.ray(column, row), box);
      if (span.from_m <= span.to_m) {
        nearest_m = std::fmin(nearest_m, span.from_m);
        farthest_m = std::fmax(farthest_m, span.to_m);
      }
      if (z_m >= span.from_m - kRounding_m && z_m <= span.to_m + kRounding_m) continue;
      ++outside;
      if (clip) z_m = kNoSurface;
    }
  }
  if (outside > 0) found.counts.emplace_back(clip ? "pixels_clipped" : "pixels_outside", outside);
  if (clip || outside < kMany * all) return "";
  return rounded(100.0 * outside / all) +
         " % of the found pixels lie outside the volume of interest, whose depths are " +
         rounded(nearest_m / kMillimetre) + " to " + rounded(farthest_m / kMillimetre) +
         " mm: another surface may be meant; --clip leaves them out";
}

/// What passes 3 and 4 make of the depths that were found, and how far they are from the truth.
PictureResult score_surface(const FoundSurface& found,
                            const ResolvedScene& scene,
                            Truth true_surface) {
  TrueView truth(std::move(true_surface), scene.view().camera);
  PictureResult result{.picture = render::shade_depth(found.depth_m, scene.render())};
  result.picture.depth_m = found.depth_m;
  Image<glm::vec3> shaded = shade_truth(truth.truth, scene.render(), {});
  PictureMeasures error = measure_picture(result.picture, truth, scene.render(), {}, &shaded);
  result.comparison = Comparison{.truth = std::move(truth.truth),
                                 .error = std::move(error),
                                 .shaded_truth = std::move(shaded)};
  return result;
}

std::string shown_file(const FoundSurface& found, const ScoreArguments& arguments) {
  return std::string(to_string(found.kind)) + " " + arguments.surface.file.string() + " (" +
         found.format + ")";
}

std::string score_summary(const FoundSurface& found,
                          const PictureResult& result,
                          const ResolvedScene& scene,
                          const ScoreArguments& arguments) {
  std::string text = "scored      " + shown_file(found, arguments) + "\n";
  for (const auto& [what, as] : found.taken) text += "            " + what + ": " + as + "\n";
  const DepthError& raw = result.comparison->error.raw;
  text += "found       " + rounded(raw.found_m2 * 1e4) + " cm2 of surface";
  for (const auto& [name, count] : found.counts) {
    if (count == 0) continue;
    std::string words = name;
    std::ranges::replace(words, '_', ' ');
    text += ", " + std::to_string(count) + " " + words;
  }
  return text + "\n" + error_text(*result.comparison, scene) + "results     " +
         arguments.output.folder.string() + "\n";
}

Json scored_json(const FoundSurface& found, const ScoreArguments& arguments) {
  Json json = {{"file", arguments.surface.file.string()},
               {"what", to_string(found.kind)},
               {"format", found.format},
               {"taken", Json::object()},
               {"counts", Json::object()}};
  for (const auto& [what, as] : found.taken) json["taken"][what] = as;
  for (const auto& [name, count] : found.counts) json["counts"][name] = count;
  return json;
}

std::string score_report(const FoundSurface& found,
                         const PictureResult& result,
                         const ResolvedScene& scene,
                         std::uint32_t volume,
                         const ScoreArguments& arguments,
                         const Progress& progress) {
  Json report = report_head("score", provenance_of_this_machine(), scene.options());
  report["scored"] = scored_json(found, arguments);
  report["board"] = {{"volume", volume}};  // where `run` has it
  report["camera"] = camera_json(scene.view().camera);
  report["truth"] = "simulated scene";
  report["error"] = error_json(result.comparison->error, expected_surface(scene));
  report["wall_ms"] = wall_json(progress.times());
  return report_text(report);
}

int score(const ScoreArguments& arguments) {
  const auto limits = parse_limits(arguments.limits, limit_names(picture_figures(nullptr, {})));
  const SurfaceFileOptions options = surface_options(arguments);
  if (!std::filesystem::is_regular_file(options.file)) {
    throw UserError("FILE = " + options.file.string() + ": there is no such file");
  }
  const ScoredScene scored = load_scored_scene(arguments);
  const auto work = [&](OutputFolder& out, Progress& progress) {
    for (const char* name : {"depth.exr", "truth_depth.exr", "error_depth.exr"}) {
      out.refuse_input(options.file, name);
    }
    PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
    const auto phantom =
        progress.step("phantom", [&] { return cache.phantom(scored.options.phantom); });
    const ResolvedScene scene = resolve_scene(scored.options, phantom);
    check_camera(scored, scene.view().camera);
    FoundSurface found = progress.step("read", [&] { return read_found_surface(options, scene); });
    progress.warn(idle_options_text(*arguments.command, conditional_options(found.kind)));
    if (found.kind == SurfaceFileKind::depth_map) {
      progress.warn(count_outside_box(found, scene, arguments.clip));
    }
    const sim::TissueMapSource maps = kept_maps(cache.tissue_maps());
    Truth truth = progress.step("truth", [&] { return true_surface(scene, maps, scored.volume); });
    const PictureResult result =
        progress.step("compare", [&] { return score_surface(found, scene, std::move(truth)); });
    progress.step("write", [&] { stage_score_images(out, result, scene); });
    const std::string summary = score_summary(found, result, scene, arguments);
    CommandResult done{
        .report = score_report(found, result, scene, scored.volume, arguments, progress),
        .summary = summary,
        .failure = {},
        .document = score_document(result, scene, summary)};
    check_limits(limits, picture_figures(&result.comparison->error, {}), done);
    return done;
  };
  return run_in_folder(arguments.output, {}, work);
}

void add_surface_options(CLI::App& command, ScoreArguments& arguments) {
  add_choice(command,
             "--unit",
             arguments.unit,
             {"auto", "mm", "m"},
             "Of the file's lengths; auto: as the file says, else mm");
  add_choice(command,
             "--kind",
             arguments.kind,
             {"ray", "z"},
             "Of a depth map: the length of the pixel's ray, or z of the camera");
  add_text(command,
           "--channel",
           arguments.surface.depths.channel,
           "Of a depth map: the channel, or the array of an .npz, that holds the depths");
  add_text(command,
           "--mask",
           arguments.surface.depths.mask,
           "Of a depth map: the channel or array that is 0 where there is no surface (NaN, and "
           "depths of 0 or less, are none anyway)");
  add_text(
      command,
      "--step-mm",
      arguments.step_mm,
      "Of a depth map: mm that a step of its numbers is, in the place of --unit; a PNG needs it");
  add_text(command,
           "--far",
           arguments.far,
           "Of a depth map: depths from this number on, in the file's unit, are no surface");
  add_flag(command,
           "--clip",
           arguments.clip,
           "Of a depth map: what lies outside the volume of interest is no surface");
  add_choice(
      command,
      "--frame",
      arguments.frame,
      {"probe", "phantom", "file"},
      "Of a mesh or a point cloud: the frame of its coordinates (docs/units.md); file: that of "
      "the mesh that was imported");
  add_text(command,
           "--point-mm",
           arguments.point_mm,
           "Of a point cloud: radius of the disc that each point covers; without it the P95 of the "
           "distance to the next point");
}

}  // namespace

Command add_score_command(CLI::App& app) {
  const auto arguments = std::make_shared<ScoreArguments>();
  CLI::App& command = add_subcommand(
      app, "score", "Another program's depth map, mesh or point cloud against a scene's truth");
  arguments->command = &command;
  add_required_path(
      command,
      "FILE",
      arguments->surface.file,
      "Depth map (.exr, .tif, .png, .pfm, .npy, .npz), mesh or point cloud (.ply, .stl, .obj)");
  add_required_path(command,
                    "--scene",
                    arguments->scene.file,
                    "report.json of a `run`, whose view and truth are taken, or a scene in TOML");
  add_list(command,
           "--set",
           arguments->scene.settings,
           "Override one option of the scene: section.key=value (repeatable)");
  add_optional_integer(command,
                       "--volume",
                       arguments->volume,
                       "Volume, from 0 on, of a scene in TOML that moves; a report says its own",
                       0,
                       hw::kMostVolumes - 1);
  add_surface_options(command, *arguments);
  add_output_options(command, arguments->output, arguments->cache);
  add_limit_option(command, arguments->limits, limit_names(picture_figures(nullptr, {})));
  add_junit_option(command, arguments->output);
  return {&command, [arguments] { return score(*arguments); }};
}

}  // namespace wobblebench::bench
