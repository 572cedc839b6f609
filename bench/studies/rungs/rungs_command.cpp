// Speed against accuracy over the rungs of the simulator.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/output/image_io.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/output/report.h"
#include "bench/scene/resolved_scene.h"
#include "bench/studies/rungs/rung_memory.h"
#include "bench/studies/rungs/rungs_report.h"
#include "sim/fidelity.h"
#include "sim/probe_simulator.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  SceneArguments scene;
  OutputArguments output;
  int repeats = 3;
};

constexpr int kSeeds = 3;
constexpr int kPanelWidth = 600;

void refuse_compared_settings(const Scene& scene) {
  for (const char* key : {"simulation.fidelity", "simulation.side_lobes"}) {
    if (scene.given.contains(key)) {
      throw UserError(std::string(key) + ": is set by the command itself; leave it out");
    }
  }
}

/// All rungs are compared, so that each must model what the options switch on.
void refuse_for_any_rung(const Scene& scene) {
  auto options = scene.simulation;
  for (const sim::Rung rung : {sim::Rung::geometry, sim::Rung::reference}) {
    options.fidelity = rung;
    try {
      sim::choose_fidelity(options, scene.plan(), scene.moves());
    } catch (const InvalidOption& error) {
      throw UserError(std::string("simulation.") + error.what());
    }
  }
}

/// At rest: the measurements set the motion.
RungScene scene_of(Scene given, const phantoms::Phantom& phantom) {
  given.motion = {};
  const ResolvedScene scene = resolve_scene(std::move(given), phantom);
  return {{phantom, scene.subject()->placement}, scene.plan(), scene.simulation()};
}

/// In processes of their own, before this one works on other threads.
std::vector<MemoryPeak> measure_memory(const Scene& scene, const PartDone& done) {
  std::vector<MemoryPeak> peaks;
  PartCount parts(1 + 2 * volume_rungs().size(), done);
  const auto add = [&](const std::string& what, const auto& body) {
    peaks.push_back({what, peak_memory_bytes(body)});
    parts.finish_one();
  };
  add("phantom alone", [&] { phantoms::make_phantom(scene.phantom); });
  for (const sim::Rung rung : volume_rungs()) {
    for (const bool moving : {false, true}) {
      add(sim::to_string(rung) + (moving ? ", moving" : ", still"), [&] {
        auto subject = scene_of(scene, phantoms::make_phantom(scene.phantom));
        subject.options.fidelity = rung;
        subject.subject.motion = moving ? slow_path() : phantoms::Motion();
        const sim::ProbeSimulator simulator(subject.subject, subject.plan, subject.options);
        simulator.volume(0);
      });
    }
  }
  return peaks;
}

std::vector<RungFrame> middle_frames(const RungScene& scene) {
  std::vector<RungFrame> panels;
  for (const sim::Rung rung : volume_rungs()) {
    auto options = scene.options;
    options.fidelity = rung;
    const auto volume = sim::ProbeSimulator(scene.subject, scene.plan, options).volume(0);
    panels.push_back(
        {sim::to_string(rung),
         frame_picture(
             scene.plan, volume, scene.plan.acquisition().frames_per_volume / 2, kPanelWidth)});
  }
  return panels;
}

/// The scene with another phantom in place of its own.
RungScene body_in(Scene scene, const std::string& name) {
  scene.phantom = {.name = name};
  if (name == "plane") scene.phantom.tilt_y_rad = 10 * kDegree;
  scene.given.clear();
  return scene_of(scene, phantoms::make_phantom(scene.phantom));
}

/// The scene's own phantom, and two whose truth has a closed form.
std::vector<RungError> measure_errors(const Scene& scene,
                                      const RungScene& subject,
                                      const std::vector<std::uint64_t>& seeds,
                                      const PartDone& done) {
  PartCount parts(4, done);
  std::vector<RungError> errors =
      measure_rung_errors(scene.phantom.name, subject, volume_rungs(), seeds);
  parts.finish_one();
  for (const std::string name : {"sphere", "plane"}) {
    if (name != scene.phantom.name) {
      const auto more = measure_rung_errors(name, body_in(scene, name), volume_rungs(), seeds);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    parts.finish_one();
  }
  const auto small = measure_rung_errors(
      "sheet", small_sheet(scene.simulation), {sim::Rung::scatterers, sim::Rung::reference}, seeds);
  errors.insert(errors.end(), small.begin(), small.end());
  return errors;
}

/// Of the steps of measure(), estimated.
std::vector<PlannedStep> usual_shares(int repeats) {
  return {{"memory", 50},
          {"phantom", 4},
          {"times", 6.0 + 6.0 * repeats},
          {"stages", 4},
          {"growth", 60},
          {"errors", 15},
          {"reference", 20},
          {"frames", 6}};
}

RungsResults measure(const Scene& scene, int repeats, Progress& progress) {
  RungsResults results;
  results.phantom = scene.phantom.name;
  results.repeats = repeats;
  results.seeds = seeds_from(scene.simulation.seed, kSeeds);
  results.memory =
      progress.step("memory", [&](const PartDone& done) { return measure_memory(scene, done); });
  const auto subject = progress.step(
      "phantom", [&] { return scene_of(scene, phantoms::make_phantom(scene.phantom)); });
  results.sound_ms = to_milliseconds(subject.plan.volume_duration());
  results.samples = static_cast<double>(subject.plan.sticks_per_volume()) *
                    subject.plan.acquisition().samples_per_stick;
  results.times = progress.step("times", [&](const PartDone& done) {
    return measure_times(subject, volume_rungs(), repeats, done);
  });
  progress.step("stages", [&](const PartDone& done) {
    PartCount parts(volume_rungs().size(), done);
    for (const sim::Rung rung : volume_rungs()) {
      results.stages.push_back(measure_stages(subject, rung));
      parts.finish_one();
    }
  });
  results.growth = progress.step("growth", [&](const PartDone& done) {
    return measure_growth(volume_rungs(), scene.simulation, {}, done);
  });
  results.errors = progress.step("errors", [&](const PartDone& done) {
    return measure_errors(scene, subject, results.seeds, done);
  });
  progress.step("reference", [&] {
    const auto small = small_sheet(scene.simulation);
    results.small_scatterers = measure_volume(small, sim::Rung::scatterers, kSmallRepeats);
    results.small_reference = measure_volume(small, sim::Rung::reference, kSmallRepeats);
  });
  results.frames = progress.step("frames", [&] { return middle_frames(subject); });
  return results;
}

Json report_of(const RungsResults& results,
               const Scene& scene,
               const Provenance& provenance,
               const StepTimes& times) {
  Json report = report_head("rungs", provenance, scene);
  report["acquisition"] = acquisition_json(scene.plan());
  report["rungs"] = rungs_json(results);
  report["wall_ms"] = wall_json(times);
  return report;
}

int rungs(const Arguments& arguments) {
  const Scene scene = load_scene(arguments.scene.file, arguments.scene.settings);
  refuse_compared_settings(scene);
  refuse_for_any_rung(scene);
  OutputFolder out(arguments.output.folder);
  Progress progress(usual_shares(arguments.repeats));
  const RungsResults results = measure(scene, arguments.repeats, progress);

  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  const std::string report = report_text(report_of(results, scene, provenance, progress.times()));
  const std::string markdown = rungs_markdown(results, provenance);
  out.write_text("rungs.md", markdown);
  out.write_text("rungs.csv", rungs_csv(results));
  for (const Figure& figure : rungs_figures(results)) {
    write_png(out.stage(rungs_figure_file(figure)), figure.picture);
  }
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : markdown);
  return 0;
}

}  // namespace

Command add_rungs_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app, "rungs", "Speed against accuracy over the simulator's rungs");
  add_scene_options(command, arguments->scene);
  add_output_options(command, arguments->output);
  add_repeats_option(command, arguments->repeats);
  return {&command, [arguments] { return rungs(*arguments); }};
}

}  // namespace wobblebench::bench
