// The path from probe to volume under seeded faults, in virtual time.
#include <cstdint>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>

#include "bench/board_checks/fault_simulation/fault_simulation.h"
#include "bench/cli/board_report.h"
#include "bench/command/commands.h"
#include "bench/command/common_options.h"
#include "bench/command/run_in_folder.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

using Json = nlohmann::ordered_json;

std::string hex(std::uint64_t value) {
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << value;
  return text.str();
}

std::string replay_command(std::uint64_t seed) {
  return "wobblebench rehearse --first-seed " + std::to_string(seed) + " --seeds 1 --trace";
}

/// What was counted, in one row.
Table counts_of(const SeedRangeResult& all) {
  using S = SeedRangeResult;
  return table_of<S>(
      {},
      std::vector<S>{all},
      {{{"steps"}, &S::steps},
       {{"sticks"}, &S::sticks},
       {{"emitted", "sticks emitted"}, [](const S& of) { return of.account.emitted; }},
       {{"delivered", "sticks delivered"}, [](const S& of) { return of.account.delivered; }},
       {{"bytes_recorded", "bytes recorded, killed anywhere"}, &S::bytes_recorded},
       {{"sticks_salvaged", "sticks salvaged"}, &S::sticks_salvaged},
       {{"device_time_s", "device time", "s"}, &S::device_time_s},
       {{"wall_s", "wall time", "s"}, &S::wall_s},
       {{"times_real_time", "times real time"},
        [](const S& of) { return of.device_time_s / of.wall_s; }},
       {{"times_acquisition", "times the sticks' own acquisition"},
        [](const S& of) { return of.acquired_s / of.wall_s; }}});
}

/// The text of report.json.
std::string fault_simulation_report(const SeedRangeResult& all) {
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  provenance.seed = all.first_seed;
  Json failures = Json::array();
  for (const auto& failed : all.failed) {
    failures.push_back(
        {{"seed", failed.seed}, {"rule", failed.failure}, {"replay", replay_command(failed.seed)}});
  }
  Json report = {{"schema", kReportSchema},
                 {"command", "rehearse"},
                 {"provenance", to_json(provenance)},
                 {"board", account_json(all.account)},
                 {"rehearsal", to_json(counts_of(all)).front()}};
  report["rehearsal"].update({{"seeds", all.seeds},
                              {"first_seed", all.first_seed},
                              {"hash", hex(all.hash)},
                              {"failures", failures}});
  return report_text(report);
}

Table failure_table(const SeedRangeResult& all) {
  Table table{.name = "failures", .columns = {{"seed"}, {"rule"}, {"replay"}}};
  for (const auto& failed : all.failed) {
    table.add(
        {std::to_string(failed.seed), failed.failure, Cell::code(replay_command(failed.seed))});
  }
  return table;
}

/// Without a name: what was rehearsed has no file beside report.json and the page.
Document fault_simulation_document(const SeedRangeResult& all) {
  Table counts{
      .name = "counts",
      .caption = "Seeds " + std::to_string(all.first_seed) + " to " +
                 std::to_string(all.first_seed + static_cast<std::uint64_t>(all.seeds) - 1),
      .columns = {{"what"}, {"value", "value", "", 1}}};
  const Table counted = counts_of(all);
  for (std::size_t i = 0; i < counted.columns.size(); ++i) {
    counts.add({heading(counted.columns[i]), counted.rows.front()[i]});
  }
  counts.add({"failures", all.failed.size()});
  Document document{.title = "Rehearsal of faults in virtual time"};
  document.add(Text{"Hash of every event: `" + hex(all.hash) + "`."})
      .add(std::move(counts))
      .add(board_table(all.account));
  if (!all.failed.empty()) document.add(Heading{"Failures"}).add(failure_table(all));
  return document;
}

struct RehearseArguments {
  OutputArguments output;
  int seeds = 1000;
  std::uint64_t first_seed = 1;
  bool trace = false;
};

void print_trace(std::uint64_t first_seed, int seeds) {
  for (int i = 0; i < seeds; ++i) {
    simulate_faults(first_seed + static_cast<std::uint64_t>(i),
                    [](const std::string& line) { std::cerr << line << "\n"; });
  }
}

int simulate(const RehearseArguments& arguments) {
  return run_in_folder(arguments.output, {}, [&](OutputFolder&, Progress& progress) {
    if (arguments.trace) print_trace(arguments.first_seed, arguments.seeds);
    const SeedRangeResult all = progress.step("rehearse", [&](const PartDone& done) {
      return simulate_seeds(arguments.first_seed, arguments.seeds, done);
    });
    return CommandResult{.report = fault_simulation_report(all),
                         .summary = {},
                         .exit_code = all.failed.empty() ? kDone : kFailed,
                         .checks = {none_failed("seeds", all.failed.size())},
                         .document = fault_simulation_document(all)};
  });
}

}  // namespace

Command add_rehearse_command(CLI::App& app) {
  const auto arguments = std::make_shared<RehearseArguments>();
  CLI::App& command = add_subcommand(
      app, "rehearse", "Play probe, link, board and volumes under seeded faults on virtual time");
  add_output_options(command, arguments->output);
  add_integer(command, "--seeds", arguments->seeds, "How many", 1, 100000000);
  add_seed(command, "--first-seed", arguments->first_seed, "The first; the others follow");
  add_flag(command, "--trace", arguments->trace, "Every event on stderr");
  return {&command, [arguments] { return simulate(*arguments); }};
}

}  // namespace wobblebench::bench
