// Time against error over a plan's settings.
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/software_renderer.h"
#include "bench/output/finished_report.h"
#include "bench/output/image_io.h"
#include "bench/output/output_folder.h"
#include "bench/output/progress.h"
#include "bench/output/report.h"
#include "bench/studies/trade/trade_report.h"

namespace wobblebench::bench {

namespace {

constexpr int kMostShards = 10000;

struct Arguments {
  std::filesystem::path plan;
  std::vector<std::string> settings;
  std::string shard = "1/1";
  std::vector<std::string> merged;
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
};

struct Shard {
  int index = 1, count = 1;
};

Shard parse_shard(const std::string& text) {
  Shard shard;
  char end = 0;
  const bool read = std::sscanf(text.c_str(), "%5d/%5d%c", &shard.index, &shard.count, &end) == 2;
  const bool allowed = read && shard.index >= 1 && shard.index <= shard.count &&
                       shard.count <= kMostShards &&
                       text == std::to_string(shard.index) + "/" + std::to_string(shard.count);
  if (!allowed) {
    throw UserError("--shard = " + text + ": must be I/N, 1 to N, with N at most " +
                    std::to_string(kMostShards));
  }
  return shard;
}

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

void measure(const Arguments& arguments,
             const TradeWork& work,
             const Shard& shard,
             TradeJournal& journal,
             Progress& progress) {
  journal.file().say_kept();
  const auto context = render::make_context(arguments.gl);
  warn_of_software(*context, arguments.gl, progress);
  journal.append_machine(measured_by(provenance_of_simulation(*context, work.plan.seeds.front())));
  PhantomCache cache = open_phantom_cache(arguments.cache.most_megabytes());
  const auto units = trade_shard(trade_units(work), shard.index, shard.count);
  progress.step("measure", [&](const PartDone& done) {
    measure_trade(work, units, journal, *context, cache, done);
  });
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

int write(const Arguments& arguments,
          const TradeResults& results,
          std::size_t kept,
          OutputFolder& out,
          Progress& progress) {
  const std::string report =
      finished_report(report_text(report_of(results, kept, progress.times())), progress);
  const std::string markdown = trade_markdown(results);
  out.write_text("trade.csv", trade_csv(results));
  out.write_text("trade.md", markdown);
  for (const TradeResults::Part& part : results.parts) {
    if (const auto figure = trade_figure(part)) {
      out.write_text("trade_" + figure->name + ".vl.json", specification(*figure).dump(1) + "\n");
    }
  }
  out.write_text("report.json", report);
  out.commit();
  std::cout << (arguments.output.json ? report : markdown);
  return 0;
}

int trade(const Arguments& arguments) {
  const Shard shard = parse_shard(arguments.shard);
  if (!arguments.merged.empty() && shard.count > 1) {
    throw UserError("--merge: measures nothing, and takes no --shard");
  }
  TradeWork work = work_of(arguments);
  OutputFolder out(arguments.output.folder);
  TradeJournal journal(out.directory(), work.hash());
  Progress progress({{"measure", 100}});
  progress.warn(idle_settings(work));
  if (!arguments.merged.empty()) {
    merge(arguments, work, journal);
  } else {
    measure(arguments, work, shard, journal, progress);
  }
  const std::size_t all = trade_units(work).size(), here = journal.records().size();
  if (here < all) {
    // A shard has no report to say it.
    progress.warn(progress.machine_use().warning());
    std::cout << "Shard " << arguments.shard << " is finished: " << here << " of " << all
              << " measurements are in " << (out.directory() / TradeJournal::kFile).string()
              << ". `wobblebench trade PLAN --merge DIR --merge DIR …` makes the report of all "
                 "shards.\n";
    return 0;
  }
  const TradeResults results =
      trade_results(std::move(work), {journal.records(), journal.file().machines()});
  return write(arguments, results, journal.file().kept(), out, progress);
}

}  // namespace

Command add_trade_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app,
      "trade",
      "Time against error over a plan's settings: the front, its knees, what matters");
  add_required_path(command, "PLAN", arguments->plan, "TOML file with scenes and axes of settings");
  add_list(command, "--set", arguments->settings, "SECTION.KEY=VALUE for every scene");
  add_text(command, "--shard", arguments->shard, "Measure part I of N alone: I/N");
  add_list(command,
           "--merge",
           arguments->merged,
           "Folder of a finished shard; repeat it for each. Nothing is measured");
  add_cache_options(command, arguments->cache);
  add_output_options(command, arguments->output);
  add_gl_option(command, arguments->gl);
  return {&command, [arguments] { return trade(*arguments); }};
}

}  // namespace wobblebench::bench
