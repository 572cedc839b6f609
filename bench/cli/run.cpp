// The main job: acquire, render, compare, write.
#include <cmath>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>

#include "bench/cli/commands.h"
#include "bench/cli/progress.h"
#include "bench/evaluation/depth_error.h"
#include "bench/evaluation/image_similarity.h"
#include "bench/evaluation/registration.h"
#include "bench/evaluation/truth.h"
#include "bench/pipeline/acquire.h"
#include "bench/report/board_report.h"
#include "bench/report/image_io.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"
#include "render/reference/reference.h"
#include "render/renderer.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

/// The picture against the scene's phantom.
struct Comparison {
  Truth truth;
  DepthError raw;
  DepthError filtered;
  ImageSimilarity shaded;
  Registration registration;
};

/// All that one run finds out.
struct RunResult {
  Acquisition acquisition;
  std::string gl_backend;
  std::string gl_renderer;
  render::Picture picture;
  std::optional<Comparison> comparison;  ///< none: nobody knows what the board looked at
};

ImageSimilarity against_shaded_truth(const render::Picture& picture,
                                     const Truth& truth,
                                     const render::RenderOptions& options) {
  if (options.ray_casting.image_size < 11) return {HUGE_VAL, HUGE_VAL};
  return compare_images(picture.surface, render::shade_depth(truth.depth_m, options).surface);
}

Json simulation_json(const SimulatedVolume& simulated, const Scene& scene) {
  const double sound_ms = hw::to_milliseconds(scene.plan().volume_duration());
  Json left_out = Json::array();
  for (const auto& effect : simulated.fidelity.effects) {
    if (effect.left_out.empty()) continue;
    left_out.push_back({{"effect", effect.name}, {"why", effect.left_out}});
  }
  return {{"rung", sim::to_string(simulated.fidelity.rung)},
          {"reason", simulated.fidelity.reason},
          {"left_out", left_out},
          {"map_ms", simulated.map_ms},
          {"once_ms", simulated.once_ms},
          {"ms_per_volume", simulated.volume_ms},
          {"times_real_time", sound_ms / simulated.volume_ms},
          {"late_ms", simulated.late_ms},
          {"packets_dropped", simulated.packets_dropped}};
}

Json to_report(const RunResult& result, const Scene& scene, const Progress& progress) {
  Provenance provenance = provenance_of_this_machine();
  provenance.gl_backend = result.gl_backend;
  provenance.gl_renderer = result.gl_renderer;
  provenance.board = hw::to_string(result.acquisition.link.origin);
  Json report = report_head("run", provenance, scene);
  const auto& simulated = result.acquisition.simulated;
  if (simulated) report["effects"] = simulated->effects;
  report["acquisition"] = acquisition_json(scene.plan());
  report["simulation"] = simulated ? simulation_json(*simulated, scene) : Json(nullptr);
  report["board"] = board_json(result.acquisition);
  report["render"] = render_json(result.picture.passes);
  const auto& comparison = result.comparison;
  report["error"] = nullptr;
  report["fit"]["registration"] = nullptr;
  if (comparison) {
    report["error"] = error_json(comparison->raw,
                                 comparison->filtered,
                                 comparison->shaded,
                                 scene.render.ray_casting.mode != render::RenderMode::volume);
    report["fit"]["registration"] = registration_json(comparison->registration);
  }
  for (const auto& [name, ms] : progress.steps()) report["wall_ms"][name] = ms;
  report["wall_ms"]["total"] = progress.total_ms();
  return report;
}

void write_results(OutputFolder& out, const RunResult& result) {
  write_png(out.stage("surface.png"), result.picture.surface);
  write_png(out.stage("volume.png"), result.picture.volume);
  write_exr_mm(out.stage("depth.exr"),
               {{"Z", &result.picture.depth_m}, {"Z_filtered", &result.picture.filtered_depth_m}});
  if (!result.comparison) return;
  write_exr_mm(out.stage("truth_depth.exr"), {{"Z", &result.comparison->truth.depth_m}});
  write_exr_mm(out.stage("error_depth.exr"), {{"Z", &result.comparison->raw.map_m}});
}

std::string figure(const Json& value) {
  if (value.is_null()) return "none";
  std::ostringstream text;
  const double number = value.get<double>();
  text << std::setprecision(3);
  if (std::abs(number) >= 100) text << std::fixed << std::setprecision(0);
  text << number;
  return text.str();
}

void print_volume(const Json& report) {
  const Json& simulation = report["simulation"];
  std::cout << "volume      " << figure(report["acquisition"]["volume_time_ms"])
            << " ms of sound, ";
  if (simulation.is_null()) {
    std::cout << report["provenance"]["board"].get<std::string>() << ", samples "
              << report["board"]["samples_from"].get<std::string>() << "\n";
    return;
  }
  std::cout << "simulated in " << figure(simulation["ms_per_volume"])
            << " ms (before the first: " << figure(simulation["map_ms"]) << " ms for the phantom, "
            << figure(simulation["once_ms"]) << " ms for the scene)\n"
            << "simulator   " << simulation["rung"].get<std::string>() << ": "
            << simulation["reason"].get<std::string>() << "\n";
}

void print_board(const Json& board) {
  std::cout << "board       " << board["emitted"] << " sticks emitted, " << board["delivered"]
            << " delivered";
  for (const auto& [cause, count] : board["lost"].items()) {
    if (count != 0) std::cout << ", " << count << " lost: " << cause;
  }
  std::cout << "\n";
}

void print_error(const Json& error) {
  if (error.is_null()) {
    std::cout << "depth error unknown: nobody knows what the board looked at\n";
    return;
  }
  std::cout << "depth error bias " << figure(error["depth_mm"]["bias"]) << " mm, RMS "
            << figure(error["depth_mm"]["rms"]) << " mm, P95 " << figure(error["depth_mm"]["p95"])
            << " mm over " << error["depth_mm"]["n"] << " pixels; missed "
            << figure(error["missed_percent"]) << " %, false " << figure(error["false_percent"])
            << " %\n";
}

void print_summary(const Json& report, const std::filesystem::path& directory) {
  print_volume(report);
  print_board(report["board"]);
  std::cout << "render      " << figure(report["render"]["frame_ms"]) << " ms on "
            << report["provenance"]["gl_renderer"].get<std::string>() << "\n";
  print_error(report["error"]);
  std::cout << "results     " << directory.string() << "\n";
}

Comparison compare(const render::Picture& picture,
                   const phantoms::PlacedPhantom& subject,
                   const Scene& scene,
                   Progress& progress) {
  const render::View view = render::make_view(scene.render);
  auto truth = progress.step("truth", [&] { return trace_truth(subject, scene.plan(), view); });
  auto [raw, filtered, shaded] = progress.step("compare", [&] {
    return std::tuple(measure_depth_error(picture.depth_m, truth, view.camera),
                      measure_depth_error(picture.filtered_depth_m, truth, view.camera),
                      against_shaded_truth(picture, truth, scene.render));
  });
  auto registration = progress.step(
      "register", [&] { return register_surface(picture.depth_m, subject, scene.plan(), view); });
  return {std::move(truth), std::move(raw), std::move(filtered), shaded, registration};
}

}  // namespace

int run_command(const CommandArguments& arguments) {
  Scene scene = load_scene(arguments.scene, arguments.settings);
  BoardConnection board(parse_board(arguments.board));
  // Before any echo is made: a machine without this GL says so now.
  const auto context = render::make_context(arguments.gl);
  OutputFolder out(arguments.out);
  Progress progress;
  board.adopt_plan(scene);
  RunResult result = [&] {
    const auto phantom =
        progress.step("phantom", [&] { return phantoms::make_phantom(scene.phantom); });
    complete_from_phantom(scene, phantom);
    const auto subject = scene.place(phantom);
    // Likewise what the driver refuses.
    render::Renderer renderer(*context, scene.plan(), scene.render);
    auto acquisition = progress.step("acquire", [&] { return board.acquire(scene, subject); });
    auto picture = progress.step("render", [&] {
      renderer.add_volume(acquisition.volume);
      return renderer.render();
    });
    std::optional<Comparison> comparison;
    if (acquisition.source == hw::StreamOrigin::simulated) {
      comparison = compare(picture, subject, scene, progress);
    }
    return RunResult{std::move(acquisition),
                     context->backend(),
                     context->renderer_string(),
                     std::move(picture),
                     std::move(comparison)};
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
  if (result.acquisition.ending.empty()) return 0;
  std::cerr << "wobblebench: --board = " << arguments.board << ": " << result.acquisition.ending
            << ": " << result.acquisition.volume.missing_sticks()
            << " sticks of the volume are missing\n";
  return 1;
}

}  // namespace wobblebench::bench
