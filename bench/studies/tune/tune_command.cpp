// The settings of a plan that a request asks for.
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "base/user_error.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/command/software_renderer.h"
#include "bench/exchange/program/renderer_process.h"
#include "bench/output/report.h"
#include "bench/studies/trade/trade_report.h"
#include "bench/studies/tune/tune_journal.h"
#include "bench/studies/tune/tune_report.h"

namespace wobblebench::bench {

namespace {

struct Arguments {
  const CLI::App* command = nullptr;
  std::filesystem::path plan;
  std::vector<std::string> settings, limits;
  std::filesystem::path trade;  ///< folder of a finished trade; empty: none
  TuneOptions tune;
  bool random = false;
  int requests = 0;  ///< 0: the one of --limit
  CacheArguments cache;
  OutputArguments output;
  std::string gl = "auto";
  std::vector<std::string> renderers;
};

TuneOptions options_of(const Arguments& arguments) {
  TuneOptions options = arguments.tune;
  check_quantity("--least", options.request.least);
  if (arguments.limits.empty()) throw UserError("--limit: must be given at least once");
  for (const std::string& limit : arguments.limits) {
    options.request.limits.push_back(parse_limit(limit));
  }
  if (arguments.random || !has_nsga2()) options.search.method = SearchMethod::random;
  return options;
}

TradeWork unseen_of(TradeWork work) {
  work.plan.scenes = work.plan.unseen;
  work.plan.strata = work.plan.unseen_strata;
  return work;
}

/// Lines about scenes of the population that are left out, unseen ones too.
std::vector<std::string> leave_out_all_refused(TradeWork& work, PhantomCache& cache) {
  std::vector<std::string> lines = leave_out_refused(work, cache);
  TradeWork unseen = unseen_of(work);
  for (std::string& line : leave_out_refused(unseen, cache)) lines.push_back(std::move(line));
  work.plan.unseen = std::move(unseen.plan.scenes);
  work.plan.unseen_strata = std::move(unseen.plan.strata);
  return lines;
}

/// Reads all scenes, so that nothing is refused after the search.
TradeWork work_of(const Arguments& arguments) {
  TradeWork work{load_trade_plan(arguments.plan), {}, arguments.settings};
  check_trade(work);
  check_trade(unseen_of(work));
  return work;
}

TradeRecords known_records(const Arguments& arguments, TradeWork& work) {
  if (arguments.trade.empty()) return {};
  TradeContent content = read_trade_journal(arguments.trade, work.hash(), "--trade");
  work.points = design_points(work.plan);
  return std::move(content.records);
}

/// What searches measure with.
struct Machine {
  explicit Machine(const Arguments& arguments)
      : context(render::make_context(arguments.gl)),
        cache(open_phantom_cache(arguments.cache.most_megabytes())) {}

  Provenance provenance(const TradeWork& work) const {
    return provenance_of_simulation(*context, work.plan.seeds.front());
  }

  std::unique_ptr<render::GlContext> context;
  PhantomCache cache;
};

/// The folder's journal, and by which machines its measurements are made.
class Journal {
 public:
  Journal(const OutputFolder& out, const TradeWork& work, const Provenance& provenance)
      : journal_(out.directory(), work.hash() + unseen_of(work).hash()) {
    journal_.file().say_kept();
    journal_.append_machine(measured_by(provenance));
  }

  TuneJournal& journal() { return journal_; }
  std::size_t kept() const { return journal_.file().kept(); }
  /// Those of measured_by(), one after the other.
  std::string machines() const {
    std::string text;
    for (const std::string& machine : journal_.file().machines()) {
      text += (text.empty() ? "" : "; ") + machine;
    }
    return text;
  }

 private:
  TuneJournal journal_;
};

std::string report_of(const TradeWork& work,
                      const std::string& key,
                      const Json& content,
                      const Provenance& provenance,
                      const Journal& journal,
                      const StepTimes& times) {
  Json report = report_head("tune", provenance, work.reference(0));
  report["provenance"]["went_on_with"] = journal.kept();
  report["scene"] = nullptr;  // there may be several
  report[key] = content;
  report["wall_ms"] = wall_json(times);
  return report_text(report);
}

std::vector<ConditionalOption> conditional_options(const Arguments& arguments) {
  const bool searches = arguments.tune.search.evaluations > 0, draws = arguments.requests > 0;
  return {{"--seed", searches || draws, "--evaluations above 0, or --requests"},
          {"--random", searches && !draws, "--evaluations above 0, without --requests"},
          {"--least", !draws, "--limit"}};
}

/// Empty: the search is the one that was asked for.
std::string without_pagmo(const Arguments& arguments) {
  if (arguments.random || arguments.tune.search.evaluations == 0 || has_nsga2()) return "";
  return "tune: searches at random: this program was built without pagmo, and so without NSGA-II "
         "(`script/bootstrap`, then `script/build run`)";
}

/// --requests
int study(const Arguments& arguments) {
  if (arguments.trade.empty()) throw UserError("--requests: needs --trade, about which it draws");
  if (!arguments.limits.empty()) throw UserError("--requests: draws its limits; leave --limit out");
  if (!without_pagmo(arguments).empty()) {
    throw std::runtime_error(
        "--requests: compares NSGA-II with others, and this program was built without pagmo");
  }
  TradeWork work = work_of(arguments);
  Machine machine(arguments);
  const auto left_out = leave_out_all_refused(work, machine.cache);
  const TradeRecords known = known_records(arguments, work);
  TuneOptions options = arguments.tune;
  options.judging_seeds = options.fresh_seeds;
  const Provenance provenance = machine.provenance(work);
  const auto measure_and_write = [&](OutputFolder& out, Progress& progress) -> CommandResult {
    warn_of_software(*machine.context, arguments.gl, progress);
    for (const std::string& line : left_out) progress.warn(line);
    progress.warn(idle_settings(work));
    progress.warn(idle_options_text(*arguments.command, conditional_options(arguments)));
    Journal journal(out, work, provenance);
    const RequestStudy study = progress.step("requests", [&](const PartDone& done) {
      return study_requests(work,
                            arguments.requests,
                            options,
                            known,
                            journal.journal(),
                            *machine.context,
                            machine.cache,
                            done);
    });
    const Document document = requests_document(study, journal.machines());
    return {.report = report_of(
                work, "requests", requests_json(study), provenance, journal, progress.times()),
            .document = document};
  };
  return run_in_folder(arguments.output, {{"requests", 100}}, measure_and_write);
}

/// Empty: a setting was found, and its checks say the rest.
std::string failure_of(const TuneResults& results) {
  if (results.chosen() != nullptr) return "";
  const std::string nearest = nearest_text(results);
  return "tune: no setting was found within the limits" +
         (nearest.empty() ? std::string("; all were refused") : "; nearest: " + nearest);
}

int tune(const Arguments& arguments) {
  if (arguments.requests > 0) return study(arguments);
  const TuneOptions options = options_of(arguments);
  TradeWork work = work_of(arguments);
  Machine machine(arguments);
  const auto left_out = leave_out_all_refused(work, machine.cache);
  const TradeRecords known = known_records(arguments, work);
  const Provenance provenance = machine.provenance(work);
  const auto search_and_write = [&](OutputFolder& out, Progress& progress) -> CommandResult {
    warn_of_software(*machine.context, arguments.gl, progress);
    for (const std::string& line : left_out) progress.warn(line);
    progress.warn(idle_settings(work));
    progress.warn(idle_options_text(*arguments.command, conditional_options(arguments)));
    progress.warn(without_pagmo(arguments));
    Journal journal(out, work, provenance);
    const TuneResults results = progress.step("search", [&](const PartDone& done) {
      return bench::tune(work,
                         options,
                         known,
                         {&journal.journal(), "search"},
                         *machine.context,
                         machine.cache,
                         done);
    });
    const Document document = tune_document(results, journal.machines());
    const bool found = results.chosen() != nullptr;
    for (std::size_t i = 0; found && i < work.plan.scenes.size(); ++i) {
      out.write_text(tuned_file(results, i), tuned_scene(results, i));
    }
    CommandResult result{
        .report =
            report_of(work, "tune", tune_json(results), provenance, journal, progress.times()),
        .exit_code = found ? kDone : kFailed,
        .failure = failure_of(results),
        .document = document};
    std::vector<Check> checks = tune_checks(results);
    if (!found) {
      result.checks = std::move(checks);
      return result;
    }
    for (Check& check : checks) add_check(std::move(check), result);
    return result;
  };
  return run_in_folder(arguments.output, {{"search", 100}}, search_and_write);
}

}  // namespace

Command add_tune_command(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& command = add_subcommand(
      app, "tune", "The settings of a plan with the least time or error within limits");
  arguments->command = &command;
  add_required_path(
      command, "PLAN", arguments->plan, "TOML file with scenes and axes, as of trade");
  add_list(command, "--set", arguments->settings, "SECTION.KEY=VALUE for every scene");
  add_text(command,
           "--least",
           arguments->tune.request.least,
           "Quantity to minimise, mean of the scenes: time or an error");
  add_list(
      command,
      "--limit",
      arguments->limits,
      "NAME<=NUMBER, as p95_mm<=2: on every scene; mean:p95_mm<=2: on their mean (repeatable)");
  add_path(command, "--trade", arguments->trade, "Folder of a trade of this plan to start from");
  add_integer(command,
              "--evaluations",
              arguments->tune.search.evaluations,
              "Points that are measured at most; 0: those of --trade alone",
              0,
              100000);
  add_integer(command,
              "--fresh-seeds",
              arguments->tune.fresh_seeds,
              "Seeds that the search does not see, to confirm on",
              2,
              100);
  add_seed(command, "--seed", arguments->tune.search.seed, "Seed of the search");
  add_integer(
      command,
      "--requests",
      arguments->requests,
      "Instead of --limit: number of requests drawn about the points of --trade; how many are "
      "kept on seeds that neither search nor confirmation saw, by NSGA-II, by a random search "
      "and by the trade alone",
      0,
      10000);
  add_flag(command, "--random", arguments->random, "Search at random, for comparison");
  add_output_options(command, arguments->output, arguments->cache);
  add_gl_option(command, arguments->gl);
  add_renderer_option(command, arguments->renderers);
  return {&command, [arguments] {
            define_renderers(arguments->renderers);
            return tune(*arguments);
          }};
}

}  // namespace wobblebench::bench
