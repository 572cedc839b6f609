// A population of scenes on disk: sticks, volumes, truth and pictures of each, and their manifest.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/shard.h"
#include "bench/output/report.h"
#include "bench/studies/dataset/dataset_report.h"
#include "bench/studies/dataset/dataset_scenes.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  const CLI::App* command = nullptr;
  std::filesystem::path plan;
  std::string shard = "1/1";
  int verified = 0;
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
};

SceneMaking making_of(const Arguments& arguments) {
  return {.gl = arguments.gl, .cache = arguments.cache};
}

/// Makes the scenes of the shard that are not there.
/// Returns its steps with their times: none where all scenes are there.
StepTimes make_scenes(const Arguments& arguments,
                      const Shard& shard,
                      const PopulationPlan& plan,
                      const DatasetFolder& folder) {
  std::vector<int> missing;
  for (int i = shard.index - 1; i < plan.scenes; i += shard.count) {
    if (!folder.has(i)) missing.push_back(i);
  }
  if (missing.empty()) return {};
  stop_in_order();
  Progress progress;
  progress.warn(idle_options_of(plan));
  std::size_t done = 0, refused = 0;
  progress.step("scenes", [&](const PartDone& part) {
    for (const int index : missing) {
      progress.note("scene " + std::to_string(index));
      const SceneOutcome outcome = make_scene(plan, index, making_of(arguments), folder);
      refused += outcome == SceneOutcome::refused ? 1 : 0;
      part(++done, missing.size());
      progress.note(std::to_string(refused) + " refused");
    }
  });
  return progress.times();
}

/// Two parts of a command, one after the other, with the total of both.
StepTimes joined(StepTimes first, const StepTimes& second) {
  double before_ms = 0;
  if (!first.empty()) {
    before_ms = first.back().second;
    first.pop_back();
  }
  first.insert(first.end(), second.begin(), second.end());
  first.back().second += before_ms;
  return first;
}

int scenes_there(const PopulationPlan& plan, const DatasetFolder& folder) {
  int there = 0;
  for (int i = 0; i < plan.scenes; ++i) there += folder.has(i) ? 1 : 0;
  return there;
}

std::string unfinished_text(const Arguments& arguments,
                            const PopulationPlan& plan,
                            const DatasetFolder& folder) {
  return "Shard " + arguments.shard +
         " is finished: " + std::to_string(scenes_there(plan, folder)) + " of " +
         std::to_string(plan.scenes) + " scenes are in " + folder.path().string() +
         ". When all are there, the same command without --shard writes manifest, sheet and "
         "page.\n";
}

CommandResult write_dataset(const Arguments& arguments,
                            const PopulationPlan& plan,
                            const DatasetFolder& folder,
                            const StepTimes& making,
                            OutputFolder& out,
                            Progress& progress) {
  const auto figures = progress.step("manifest", [&] { return stage_manifest(plan, folder, out); });
  Document document =
      progress.step("pictures", [&] { return dataset_document(plan, folder, figures, out); });
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  Json report = report_head("dataset", provenance, plan.scene(plan.draw(0)));
  report["scene"] = nullptr;  // there are several
  report["dataset"] = dataset_json(plan, figures);
  report["wall_ms"] = wall_json(joined(making, progress.times()));
  const std::string refused = report["dataset"]["refused"].dump();
  CommandResult done{.report = report_text(report),
                     .summary = std::to_string(plan.scenes) + " scenes, " + refused +
                                " refused\nresults     " + arguments.output.folder.string() + "\n",
                     .failure = {},
                     .document = std::move(document)};
  add_check({.group = "dataset",
             .name = "no scene is refused",
             .failure = refused == "0" ? ""
                                       : refused + " of " + std::to_string(plan.scenes) +
                                             " scenes were refused: manifest.jsonl says why",
             .limit = 0,
             .value = report["dataset"]["refused"].get<double>()},
            done);
  return done;
}

/// Makes some of the scenes again, and says which files differ.
CommandResult verify(const Arguments& arguments,
                     const PopulationPlan& plan,
                     const DatasetFolder& folder,
                     Progress& progress) {
  const auto scenes = scenes_to_verify(plan, folder, static_cast<std::size_t>(arguments.verified));
  if (scenes.empty()) {
    throw UserError("--verify: there is no scene in " + arguments.output.folder.string());
  }
  std::vector<std::string> differences;
  progress.step("verify", [&](const PartDone& done) {
    std::size_t made = 0;
    for (const int index : scenes) {
      for (std::string& line : verify_scene(plan, index, making_of(arguments), folder)) {
        differences.push_back(std::move(line));
      }
      done(++made, scenes.size());
    }
  });
  std::string summary = std::to_string(scenes.size()) + " scenes were made again, ";
  summary += differences.empty() ? "all files are the same bit for bit\n"
                                 : std::to_string(differences.size()) + " files differ:\n";
  for (const std::string& line : differences) summary += line + "\n";
  return {.report = {},
          .summary = summary,
          .exit_code = differences.empty() ? kDone : kFailed,
          .failure = {}};
}

void check_arguments(const Arguments& arguments, const Shard& shard) {
  if (arguments.verified == 0) return;
  if (shard.count > 1)
    throw UserError("--verify: makes scenes of all shards, and takes no --shard");
  if (std::filesystem::exists(arguments.output.folder / "dataset.json")) return;
  throw UserError("--verify: there is no data set in " + arguments.output.folder.string());
}

int dataset(const Arguments& arguments) {
  const Shard shard = parse_shard(arguments.shard);
  check_arguments(arguments, shard);
  const PopulationPlan plan = load_population_plan(arguments.plan);
  const DatasetFolder folder(arguments.output.folder, plan, arguments.verified == 0);
  if (arguments.verified > 0) {
    return run_in_folder(arguments.output, {}, [&](OutputFolder&, Progress& progress) {
      return verify(arguments, plan, folder, progress);
    });
  }
  const StepTimes making = make_scenes(arguments, shard, plan, folder);
  // Shards end at the same time: none of them may need the folder for itself.
  if (shard.count > 1 || scenes_there(plan, folder) < plan.scenes) {
    std::cout << unfinished_text(arguments, plan, folder);
    return kDone;
  }
  return run_in_folder(arguments.output, {}, [&](OutputFolder& out, Progress& progress) {
    return write_dataset(arguments, plan, folder, making, out, progress);
  });
}

}  // namespace

Command add_dataset_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command =
      add_subcommand(app,
                     "dataset",
                     "Scenes drawn from a plan: sticks, volume, truth and pictures of each, and a "
                     "manifest");
  arguments->command = &command;
  add_required_path(
      command, "PLAN", arguments->plan, "TOML file with distributions and strata of options");
  add_text(command, "--shard", arguments->shard, "Make part I of N alone: I/N");
  add_optional_integer(command,
                       "--verify",
                       arguments->verified,
                       "Make this number of scenes again and compare them bit for bit; nothing is "
                       "added. Exit code 1 if one differs",
                       1,
                       kMostScenes);
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return dataset(*arguments); }};
}

}  // namespace wobblebench::bench
