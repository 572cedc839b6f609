// Two programs, settings or kept figures on the same scenes and seeds, judged by limits.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/report.h"
#include "bench/scene/scene.h"
#include "bench/studies/compare/compare_document.h"
#include "bench/studies/compare/compared_side.h"
#include "bench/studies/compare/history.h"

namespace wobblebench::bench {

namespace {

namespace fs = std::filesystem;

struct Arguments {
  OutputArguments output;
  fs::path base;
  std::string now;  ///< `now`: empty: the base is measured, for later
  std::vector<std::string> scenes, settings, base_settings, new_settings;
  fs::path limits, history;
  int seeds = 0;  ///< 0: those of a kept base, else kSeeds
};

constexpr int kSeeds = 5;

struct Pictures {
  KeptPictures base, now;
};

/// Everything that is measured: both sides, or one alone, which is kept for later.
struct Measurement {
  ComparedSide base, now;
  std::vector<ComparedScene> scenes;
  std::map<std::string, Pictures> pictures;  ///< of each scene's first seed
  std::vector<std::string> new_settings;     ///< of NEW alone
};

/// `wanted`: 0: not given.
std::vector<std::uint64_t> seeds_of(const Measurement& all, const std::string& scene, int wanted) {
  std::vector<std::uint64_t> seeds;
  if (wanted == 0) {
    for (const MeasuredRun& run : all.base.measured.runs) {
      if (all.base.measured.kept && run.scene == scene) seeds.push_back(run.seed);
    }
    std::ranges::sort(seeds);
    seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
  }
  if (!seeds.empty()) return seeds;
  seeds.resize(static_cast<std::size_t>(wanted > 0 ? wanted : kSeeds));
  std::iota(seeds.begin(), seeds.end(), 1);
  return seeds;
}

/// A side's run of a scene; nothing where its figures were kept.
void measure_if_program(ComparedSide& side,
                        const ComparedScene& scene,
                        std::uint64_t seed,
                        KeptPictures& pictures) {
  if (!side.program) return;
  KeptPictures made = measure(side, scene, seed);
  if (pictures.surface.empty()) pictures = std::move(made);
}

/// Throws UserError where a kept base was measured on another body than `now` has, other than by a
/// setting of NEW alone.
void refuse_other_body(const Measurement& all,
                       const std::string& scene,
                       const std::map<std::string, std::string>& now) {
  const auto& base_settings = all.base.measured.settings;
  if (!all.base.measured.kept || !base_settings.contains(scene)) return;
  const auto is_set = [&](const std::string& key) {
    return std::ranges::any_of(all.new_settings,
                               [&](const auto& one) { return one.starts_with(key + "="); });
  };
  for (const auto& [key, value] : base_settings.at(scene)) {
    const bool is_of_body =
        key.starts_with("phantom.") || key.starts_with("placement.") || key.starts_with("motion.");
    const auto other = now.find(key);
    if (!is_of_body || other == now.end() || other->second == value || is_set(key)) continue;
    if (other->second == "null") continue;  // follows from others
    throw UserError(scene + ": " + key + " = " + other->second + ", but BASE = " + all.base.text +
                    " was measured with " + value +
                    ": figures of two bodies are not compared; give the same --scene and --set");
  }
}

/// Runs of both sides in turn, the new one first at every second seed, so that what the machine
/// does meanwhile meets both.
void measure_all(Measurement& all, int wanted_seeds, const PartDone& done) {
  std::size_t made = 0, planned = 0;
  for (const auto& scene : all.scenes) planned += seeds_of(all, scene.name, wanted_seeds).size();
  for (const ComparedScene& scene : all.scenes) {
    Pictures& pictures = all.pictures[scene.name];
    for (const std::uint64_t seed : seeds_of(all, scene.name, wanted_seeds)) {
      const auto run_base = [&] { measure_if_program(all.base, scene, seed, pictures.base); };
      if (seed % 2 == 1) run_base();
      measure_if_program(all.now, scene, seed, pictures.now);
      refuse_other_body(all, scene.name, all.now.measured.settings[scene.name]);
      if (seed % 2 == 0) run_base();
      done(++made, planned);
    }
  }
}

/// A kept run has its phantom's name; it is compared on the only scene.
void name_kept_run(Measurement& all) {
  auto& base = all.base.measured;
  if (!base.kept || !all.now.program || all.scenes.size() != 1 || base.runs.size() != 1) return;
  MeasuredRun& run = base.runs.front();
  if (run.scene == all.scenes.front().name) return;
  base.settings[all.scenes.front().name] = base.settings[run.scene];
  run.scene = all.scenes.front().name;
}

/// What makes no sense where one side is measured for later.
void refuse_alone(const Arguments& arguments, const ComparedSide& base) {
  if (!base.program) throw UserError("NEW: is missing; BASE has figures that were kept");
  if (!arguments.new_settings.empty())
    throw UserError("--new-set: without effect: there is no NEW");
  if (!arguments.limits.empty() && arguments.history.empty()) {
    throw UserError("--limits: without effect: there is no NEW");
  }
}

/// Before any run: reads each scene as this program will. Another program may have other options.
void refuse_wrong_settings(const Measurement& all) {
  for (const ComparedSide* side : {&all.base, &all.now}) {
    if (!side->program || side->text != "this") continue;
    for (const ComparedScene& scene : all.scenes) {
      const Scene read = load_scene(scene.file, side->program->settings);
      if (side == &all.now) {
        refuse_other_body(all, scene.name, settings_in({{"scene", scene_json(read)}}));
      }
    }
  }
}

Measurement planned(const Arguments& arguments) {
  Measurement all{.scenes = compared_scenes(arguments.scenes),
                  .new_settings = arguments.new_settings};
  ComparedSide base =
      parse_side("base", arguments.base.string(), arguments.settings, arguments.base_settings);
  if (arguments.now.empty()) {
    refuse_alone(arguments, base);
    all.now = std::move(base);
    return all;
  }
  if (!arguments.history.empty()) {
    throw UserError("--history: acts without NEW: " + arguments.base.string() +
                    " is measured and held against the commits before it");
  }
  all.base = std::move(base);
  all.now = parse_side("new", arguments.now, arguments.settings, arguments.new_settings);
  if (!all.now.program) {
    if (all.base.program) {
      throw UserError("NEW = " + arguments.now + ": figures that were kept can be BASE, not NEW");
    }
    if (!arguments.scenes.empty() || arguments.seeds > 0) {
      throw UserError(
          "--scene and --seeds: without effect: both sides have figures that were kept");
    }
    if (all.base.measured.board != all.now.measured.board) {
      throw UserError("NEW = " + arguments.now + ": was run with --board " +
                      all.now.measured.board + ", BASE with " + all.base.measured.board);
    }
    all.scenes.clear();
    for (const auto& [scene, now] : all.now.measured.settings) {
      refuse_other_body(all, scene, now);
      all.scenes.push_back({scene, {}});
    }
  }
  all.now.measured.board = all.base.measured.board;
  name_kept_run(all);
  return all;
}

void stage_picture(OutputFolder& out,
                   const std::string& scene,
                   const std::string& kind,
                   const Pictures& of,
                   std::string KeptPictures::*which,
                   std::vector<std::string>& staged) {
  const std::string base = of.base.*which, now = of.now.*which;
  if (!now.empty()) out.write_text(compared_picture("new", scene, kind), now);
  if (now.empty() || base.empty()) return;
  out.write_text(compared_picture("base", scene, kind), base);
  staged.push_back(scene);
}

/// Those of kept sides, and what both sides' say of each other.
void take_pictures(Measurement& all, int wanted_seeds) {
  for (const ComparedScene& scene : all.scenes) {
    Pictures& of = all.pictures[scene.name];
    if (all.base.measured.kept) of.base = kept_pictures(all.base, scene);
    if (all.now.measured.kept) of.now = kept_pictures(all.now, scene);
    const std::uint64_t seed = seeds_of(all, scene.name, wanted_seeds).front();
    add_likeness(all.base.measured, of.base, all.now.measured, of.now, scene.name, seed);
  }
}

void stage_pictures(const Measurement& all, OutputFolder& out, ComparisonResult& result) {
  for (const ComparedScene& scene : all.scenes) {
    const Pictures& of = all.pictures.at(scene.name);
    stage_picture(out, scene.name, "surface", of, &KeptPictures::surface, result.with_surface);
    stage_picture(out, scene.name, "error", of, &KeptPictures::error, result.with_error);
  }
}

std::string report_of(const ComparisonResult& result, const StepTimes& times) {
  Json report = {{"schema", kReportSchema},
                 {"command", "compare"},
                 {"provenance", to_json(provenance_of_this_machine())},
                 {"verdicts", Json::array()}};
  report["provenance"].erase("seed");  // each run has its own
  for (const Verdict& verdict : result.verdicts) {
    report["verdicts"].push_back({{"scene", verdict.scene},
                                  {"figure", verdict.limit.figure},
                                  {"limit", text_of(verdict.limit)},
                                  {"outcome", to_string(verdict.outcome)},
                                  {"base", number(verdict.base.mean)},
                                  {"new", number(verdict.now.mean)},
                                  {"change", number(verdict.change.mean)},
                                  {"half", number(verdict.change.half)},
                                  {"pairs", verdict.change.n},
                                  {"why", verdict.why}});
  }
  report["measured_twice"] = result.measured_twice;
  report["base"] = json_of(result.base);
  report["new"] = json_of(result.now);
  report["wall_ms"] = wall_json(times);
  return report_text(report);
}

std::string failure_of(const ComparisonResult& result) {
  std::string lines;
  for (const Verdict& verdict : result.verdicts) {
    if (verdict.outcome != Outcome::broken) continue;
    lines.append(lines.empty() ? "" : "\n").append(line_of(verdict));
  }
  const bool none = !result.verdicts.empty() && std::ranges::all_of(result.verdicts, [](auto& one) {
    return one.outcome == Outcome::not_compared;
  });
  return none ? "nothing was compared: " + result.verdicts.front().why : lines;
}

/// Adds the newest figures to the folder, and what they are beside the others to the page.
void keep_record(const fs::path& folder,
                 const std::vector<HistoryRecord>& history,
                 const ComparisonResult& result,
                 Document& document) {
  document.add(Heading{"History"});
  for (Figure& figure :
       history_figures(before(history, result.now), result.base, result.now, result.limits)) {
    document.add(std::move(figure));
  }
  write_record(folder, {utc_now(), result.now});
}

int compare(const Arguments& arguments) {
  const std::vector<ChangeLimit> limits =
      arguments.limits.empty() ? default_change_limits() : read_change_limits(arguments.limits);
  Measurement all = planned(arguments);
  refuse_wrong_settings(all);
  const std::vector<HistoryRecord> history =
      arguments.history.empty() ? std::vector<HistoryRecord>() : read_history(arguments.history);

  const auto work = [&](OutputFolder& out, Progress& progress) {
    const auto judge = [&](const char* step) {
      if (all.now.program) {
        progress.step(step, [&](const PartDone& done) { measure_all(all, arguments.seeds, done); });
      }
      take_pictures(all, arguments.seeds);
      const std::vector<HistoryRecord> earlier = before(history, all.now.measured);
      if (!earlier.empty()) all.base.measured = median_side(earlier, all.now.measured);
      const bool alone = arguments.now.empty() && all.base.measured.runs.empty();
      return alone ? std::vector<Verdict>() : verdicts(all.base.measured, all.now.measured, limits);
    };
    ComparisonResult result{.limits = limits, .verdicts = judge("measure")};
    if (only_times_are_broken(result.verdicts)) {
      result.measured_twice = true;
      result.verdicts = judge("measure again");
    }
    stage_pictures(all, out, result);
    result.base = all.base.measured;
    result.now = all.now.measured;
    const std::string failure = failure_of(result);
    Document document = compare_document(result);
    if (!arguments.history.empty()) keep_record(arguments.history, history, result, document);
    if (!history.empty() && result.base.runs.empty()) {
      progress.warn("--history = " + arguments.history.string() + ": of its " +
                    std::to_string(history.size()) +
                    " records none is of another commit with the same scenes, seeds and settings: "
                    "nothing was judged");
    }
    return CommandResult{.report = report_of(result, progress.times()),
                         .summary = verdict_line(result) + "\n" + verdict_lines(result) +
                                    "results     " + out.directory().string() + "\n",
                         .exit_code = failure.empty() ? kDone : kFailed,
                         .failure = failure,
                         .checks = test_cases(result),
                         .document = std::move(document)};
  };
  return run_in_folder(arguments.output, {{"measure", 60}, {"measure again", 0}}, work);
}

}  // namespace

Command add_compare_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "compare", "Two programs, settings or kept figures on the same scenes and seeds");
  add_required_path(command,
                    "BASE",
                    arguments->base,
                    "What NEW is held against: this (the running program), the file of another "
                    "wobblebench program, or a folder of `compare` or `run`");
  add_text(command, "NEW", arguments->now, "Likewise; without it, BASE is measured for later");
  add_list(
      command, "--scene", arguments->scenes, "Scene (TOML; repeatable); default: the defaults");
  add_list(command, "--set", arguments->settings, "Option of both sides: section.key=value");
  add_list(command, "--base-set", arguments->base_settings, "Option of BASE alone");
  add_list(command, "--new-set", arguments->new_settings, "Option of NEW alone");
  add_optional_integer(command,
                       "--seeds",
                       arguments->seeds,
                       "Seeds from 1 on, of each scene; default: those of a kept BASE, else 5",
                       1,
                       100);
  add_path(command,
           "--limits",
           arguments->limits,
           "What may change (TOML); default: the limits of docs/scenes/compare.toml");
  add_path(command,
           "--history",
           arguments->history,
           "Folder with a record of each commit, to which BASE is added; it is held against the "
           "median of the earlier ones");
  command.get_option("--history")->type_name("FOLDER");
  add_output_options(command, arguments->output);
  add_junit_option(command, arguments->output);
  return {&command, [arguments] { return compare(*arguments); }};
}

}  // namespace wobblebench::bench
