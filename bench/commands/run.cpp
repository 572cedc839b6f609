// The main job: acquire, render, compare, write.
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>

#include "bench/acquire.h"
#include "bench/commands/commands.h"
#include "bench/depth_error.h"
#include "bench/image_io.h"
#include "bench/image_similarity.h"
#include "bench/output_folder.h"
#include "bench/progress.h"
#include "bench/registration.h"
#include "bench/report.h"
#include "bench/truth.h"
#include "render/reference.h"
#include "render/renderer.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

/// All that one run finds out.
struct RunResult {
  Acquisition acquisition;
  std::string gl_renderer;
  render::Picture picture;
  Truth truth;
  DepthError raw;
  DepthError filtered;
  ImageSimilarity shaded;
  Registration registration;
};

ImageSimilarity against_shaded_truth(const render::Picture& picture,
                                     const Truth& truth,
                                     const render::RenderOptions& options) {
  if (options.ray_casting.image_size < 11) return {HUGE_VAL, HUGE_VAL};
  return compare_images(picture.surface, render::shade_depth(truth.depth_m, options).surface);
}

render::Picture render_frames(render::Renderer& renderer, const hw::PolarVolume& volume) {
  const int frames = static_cast<int>(volume.frames().size());
  for (int frame = 0; frame < frames; ++frame) renderer.add_frame(frame, volume.frame(frame));
  return renderer.render();
}

Json board_json(const hw::BoardAccount& account) {
  return {{"emitted", account.emitted},
          {"delivered", account.delivered},
          {"lost",
           {{"ring_full", account.lost.ring_full},
            {"link", account.lost.link},
            {"corrupt", account.lost.corrupt},
            {"out_of_order", account.lost.out_of_order}}}};
}

Json simulation_json(const Acquisition& acquisition, const Scene& scene) {
  const double sound_ms = hw::to_milliseconds(scene.plan().volume_duration());
  Json left_out = Json::array();
  for (const auto& effect : acquisition.fidelity.effects) {
    if (effect.left_out.empty()) continue;
    left_out.push_back({{"effect", effect.name}, {"why", effect.left_out}});
  }
  return {{"rung", sim::to_string(acquisition.fidelity.rung)},
          {"reason", acquisition.fidelity.reason},
          {"left_out", left_out},
          {"map_ms", acquisition.map_ms},
          {"once_ms", acquisition.once_ms},
          {"ms_per_volume", acquisition.volume_ms},
          {"times_real_time", sound_ms / acquisition.volume_ms},
          {"transport_ms", acquisition.transport_ms}};
}

Json to_report(const RunResult& result, const Scene& scene, const Progress& progress) {
  Provenance provenance = provenance_of_this_machine();
  provenance.gl_renderer = result.gl_renderer;
  provenance.board = result.acquisition.provenance;
  Json report = report_head("run", provenance, scene);
  report["effects"] = result.acquisition.effects;
  report["acquisition"] = acquisition_json(scene.plan());
  report["simulation"] = simulation_json(result.acquisition, scene);
  report["board"] = board_json(result.acquisition.account);
  report["render"] = render_json(result.picture.passes);
  report["error"] = error_json(result.raw,
                               result.filtered,
                               result.shaded,
                               scene.render.ray_casting.mode != render::RenderMode::volume);
  report["fit"]["registration"] = registration_json(result.registration);
  for (const auto& [name, ms] : progress.steps()) report["wall_ms"][name] = ms;
  report["wall_ms"]["total"] = progress.total_ms();
  return report;
}

void write_results(OutputFolder& out, const RunResult& result) {
  write_png(out.stage("surface.png"), result.picture.surface);
  write_png(out.stage("volume.png"), result.picture.volume);
  write_exr_mm(out.stage("depth.exr"),
               {{"Z", &result.picture.depth_m}, {"Z_filtered", &result.picture.filtered_depth_m}});
  write_exr_mm(out.stage("truth_depth.exr"), {{"Z", &result.truth.depth_m}});
  write_exr_mm(out.stage("error_depth.exr"), {{"Z", &result.raw.map_m}});
}

void print_summary(const Json& report, const std::filesystem::path& directory) {
  const Json& error = report["error"];
  const auto figure = [](const Json& value) {
    if (value.is_null()) return std::string("none");
    std::ostringstream text;
    const double number = value.get<double>();
    text << std::setprecision(3);
    if (std::abs(number) >= 100) text << std::fixed << std::setprecision(0);
    text << number;
    return text.str();
  };
  std::cout << "volume      " << figure(report["acquisition"]["volume_time_ms"])
            << " ms of sound, simulated in " << figure(report["simulation"]["ms_per_volume"])
            << " ms (before the first: " << figure(report["simulation"]["map_ms"])
            << " ms for the phantom, " << figure(report["simulation"]["once_ms"])
            << " ms for the scene)\n"
            << "simulator   " << report["simulation"]["rung"].get<std::string>() << ": "
            << report["simulation"]["reason"].get<std::string>() << "\n"
            << "board       " << report["board"].dump() << "\n"
            << "render      " << figure(report["render"]["frame_ms"]) << " ms on "
            << report["provenance"]["gl_renderer"].get<std::string>() << "\n"
            << "depth error bias " << figure(error["depth_mm"]["bias"]) << " mm, RMS "
            << figure(error["depth_mm"]["rms"]) << " mm, P95 " << figure(error["depth_mm"]["p95"])
            << " mm over " << error["depth_mm"]["n"] << " pixels; missed "
            << figure(error["missed_percent"]) << " %, false " << figure(error["false_percent"])
            << " %\n"
            << "results     " << directory.string() << "\n";
}

}  // namespace

int run_command(const CommandArguments& arguments) {
  Scene scene = load_scene(arguments.scene, arguments.settings);
  const BoardArguments board = parse_board(arguments.board);
  OutputFolder out(arguments.out);
  Progress progress;
  RunResult result = [&] {
    const auto phantom =
        progress.step("phantom", [&] { return phantoms::make_phantom(scene.phantom); });
    complete_from_phantom(scene, phantom);
    const auto placement = scene.phantom_placement();
    const auto motion = scene.phantom_motion(phantom);
    const auto plan = scene.plan();
    // Before any echo is made: what the driver refuses is refused now.
    const auto context = render::make_context();
    render::Renderer renderer(*context, plan, scene.render);
    auto acquisition = progress.step("acquire", [&] { return acquire(board, scene, phantom); });
    auto picture =
        progress.step("render", [&] { return render_frames(renderer, acquisition.volume); });
    auto truth = progress.step(
        "truth", [&] { return trace_truth(phantom, placement, motion, plan, scene.render); });
    auto [raw, filtered, shaded] = progress.step("compare", [&] {
      return std::tuple(measure_depth_error(picture.depth_m, truth, scene.render),
                        measure_depth_error(picture.filtered_depth_m, truth, scene.render),
                        against_shaded_truth(picture, truth, scene.render));
    });
    auto registration = progress.step("register", [&] {
      return register_surface(picture.depth_m, phantom, placement, motion, plan, scene.render);
    });
    return RunResult{std::move(acquisition),
                     context->renderer_string(),
                     std::move(picture),
                     std::move(truth),
                     std::move(raw),
                     std::move(filtered),
                     shaded,
                     registration};
  }();
  progress.step("write", [&] { write_results(out, result); });
  const Json report = to_report(result, scene, progress);
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  if (arguments.json) {
    std::cout << report.dump(2) << "\n";
  } else {
    print_summary(report, out.directory());
  }
  return 0;
}

}  // namespace wobblebench::bench
