// Time against error over a plan's settings.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/shard.h"
#include "bench/command/software_renderer.h"
#include "bench/exchange/program/renderer_process.h"
#include "bench/output/image_io.h"
#include "bench/output/report.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  const CLI::App* command = nullptr;
  std::filesystem::path plan;
  std::vector<std::string> settings;
  std::string shard = "1/1";
  std::vector<std::string> merged;
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
  std::vector<std::string> renderers;
};

TradeWork work_of(const Arguments& arguments) {
  TradeWork work{load_trade_plan(arguments.plan), {}, arguments.settings};
  check_trade(work);
  work.points = design_points(work.plan);
  return work;
}

/// Nothing is written where measurements are missing.
void merge(const Arguments& arguments, const TradeWork& work, TradeJournal& journal) {
  TradeContent merged;
  for (const std::string& folder : arguments.merged) {
    TradeContent content = read_trade_journal(folder, work.hash(), "--merge");
    merged.records.merge(content.records);
    merged.machines.merge(content.machines);
  }
  const auto units = trade_units(work);
  const auto missing = std::ranges::count_if(units, [&](const TradeUnit& unit) {
    return !merged.records.contains(unit) && !journal.records().contains(unit);
  });
  if (missing > 0) {
    throw UserError("--merge: " + std::to_string(missing) + " of " + std::to_string(units.size()) +
                    " measurements are in none of the folders; finish their shards first");
  }
  for (const std::string& machine : merged.machines) journal.append_machine(machine);
  for (const TradeUnit& unit : units) {
    const auto found = merged.records.find(unit);
    if (found != merged.records.end()) journal.append(found->second);
  }
}

constexpr std::size_t kMostPictures = 12;

/// Pictures of points of the first front, on the first scene and seed.
TradePictures write_pictures(const TradeResults& results,
                             render::GlContext& context,
                             PhantomCache& cache,
                             OutputFolder& out,
                             const PartDone& done) {
  const TradeResults::Part& part = results.parts.front();
  const std::size_t count = std::min(part.front.size(), kMostPictures);
  TradeMeasurement measurement(results.work, context, cache);
  TradePictures files;
  PartCount parts(count, done);
  for (std::size_t i = 0; i < count; ++i) {
    // From all of the front, which goes from fast to slow.
    const std::size_t point = part.scores[part.front[i * part.front.size() / count]].point;
    const std::string file = "trade_point_" + std::to_string(point) + ".png";
    write_png(out.stage(file), measurement.picture({0, point, 0}), Values::light);
    files[point] = file;
    parts.finish_one();
  }
  return files;
}

/// What measures.
struct Machine {
  std::unique_ptr<render::GlContext> context;
  PhantomCache cache;
};

Machine measure(const Arguments& arguments,
                const TradeWork& work,
                const Shard& shard,
                TradeJournal& journal,
                Progress& progress) {
  journal.file().say_kept();
  Machine machine{render::make_context(arguments.gl),
                  open_phantom_cache(arguments.cache.most_megabytes())};
  warn_of_software(*machine.context, arguments.gl, progress);
  journal.append_machine(
      measured_by(provenance_of_simulation(*machine.context, work.plan.seeds.front())));
  const auto units = trade_shard(trade_units(work), shard.index, shard.count);
  progress.step("measure", [&](const PartDone& done) {
    measure_trade(work, units, journal, *machine.context, machine.cache, done);
  });
  return machine;
}

/// `kept`: measurements of an interrupted command.
Json report_of(const TradeResults& results, std::size_t kept, const StepTimes& times) {
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  Json report = report_head("trade", provenance, results.work.reference(0));
  report["provenance"]["went_on_with"] = kept;
  report["scene"] = nullptr;  // there are several
  report["machines"] = results.machines;
  report["trade"] = trade_json(results);
  report["wall_ms"] = wall_json(times);
  return report;
}

std::string shard_text(const Arguments& arguments,
                       std::size_t here,
                       std::size_t all,
                       const OutputFolder& out) {
  return "Shard " + arguments.shard + " is finished: " + std::to_string(here) + " of " +
         std::to_string(all) + " measurements are in " +
         (out.directory() / TradeJournal::kFile).string() +
         ". `wobblebench trade PLAN --merge DIR --merge DIR …` makes the report of all shards.\n";
}

/// Nothing is measured, and so no scene is made.
std::vector<ConditionalOption> conditional_options(const Arguments& arguments) {
  std::vector<ConditionalOption> options;
  for (const char* name : {"--gl", "--no-cache", "--cache-mb"}) {
    options.push_back(
        {name, arguments.merged.empty(), "measurements, which --merge makes none of"});
  }
  return options;
}

CommandResult measure_and_write(const Arguments& arguments,
                                const Shard& shard,
                                TradeWork work,
                                OutputFolder& out,
                                Progress& progress) {
  if (!work.plan.strata.empty()) {
    PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
    const auto left_out = progress.step(
        "phantoms", [&](const PartDone& done) { return leave_out_refused(work, cache, done); });
    for (const std::string& line : left_out) progress.warn(line);
  }
  TradeJournal journal(out.directory(), work.hash());
  progress.warn(idle_settings(work));
  progress.warn(idle_options_text(*arguments.command, conditional_options(arguments)));
  std::optional<Machine> machine;
  if (!arguments.merged.empty()) {
    merge(arguments, work, journal);
  } else {
    machine.emplace(measure(arguments, work, shard, journal, progress));
  }
  const std::size_t all = trade_units(work).size(), here = journal.records().size();
  if (here < all) return {.summary = shard_text(arguments, here, all, out)};
  const TradeResults results = trade_results(work, {journal.records(), journal.file().machines()});
  TradePictures pictures;
  if (machine) {
    pictures = progress.step("pictures", [&](const PartDone& done) {
      return write_pictures(results, *machine->context, machine->cache, out, done);
    });
  }
  const Document document = trade_document(results, pictures);
  return {.report = report_text(report_of(results, journal.file().kept(), progress.times())),
          .document = document};
}

int trade(const Arguments& arguments) {
  const Shard shard = parse_shard(arguments.shard);
  if (!arguments.merged.empty() && shard.count > 1) {
    throw UserError("--merge: measures nothing, and takes no --shard");
  }
  const TradeWork work = work_of(arguments);
  return run_in_folder(arguments.output,
                       {{"measure", 98}, {"pictures", 2}},
                       [&](OutputFolder& out, Progress& progress) {
                         return measure_and_write(arguments, shard, work, out, progress);
                       });
}

}  // namespace

Command add_trade_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app,
      "trade",
      "Time against error over a plan's settings: the front, its knees, what matters");
  arguments->command = &command;
  add_required_path(command, "PLAN", arguments->plan, "TOML file with scenes and axes of settings");
  add_list(command, "--set", arguments->settings, "SECTION.KEY=VALUE for every scene");
  add_text(command, "--shard", arguments->shard, "Measure part I of N alone: I/N");
  add_list(command,
           "--merge",
           arguments->merged,
           "Folder of a finished shard; repeat it for each. Nothing is measured");
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  add_renderer_option(command, arguments->renderers);
  return {&command, [arguments] {
            define_renderers(arguments->renderers);
            return trade(*arguments);
          }};
}

}  // namespace wobblebench::bench
