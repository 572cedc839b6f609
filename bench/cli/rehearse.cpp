// The path from probe to volume under seeded faults, on virtual time.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <iomanip>
#include <iostream>

#include "bench/checks/fault_simulation/fault_simulation.h"
#include "bench/checks/fault_simulation/oracle.h"
#include "bench/cli/commands.h"
#include "bench/report/output_folder.h"
#include "bench/report/report.h"

namespace wobblebench::bench {

namespace {

struct FaultSimulation {
  std::vector<FaultSimulationResult> failed;
  std::uint64_t hash = 0;  ///< of all hashes, in the order of the seeds
  double device_time_s = 0;
  double acquired_s = 0;
  double wall_s = 0;
  std::uint64_t steps = 0;
  std::uint64_t sticks = 0;
  hw::BoardAccount account;
};

void add(hw::BoardAccount& sum, const hw::BoardAccount& account) {
  sum.emitted += account.emitted;
  sum.delivered += account.delivered;
  sum.lost.ring_full += account.lost.ring_full;
  sum.lost.link += account.lost.link;
  sum.lost.corrupt += account.lost.corrupt;
  sum.lost.out_of_order += account.lost.out_of_order;
  sum.duplicates += account.duplicates;
}

FaultSimulation rehearse_all(const CommandArguments& arguments) {
  const auto start = std::chrono::steady_clock::now();
  std::vector<FaultSimulationResult> results(static_cast<std::size_t>(arguments.seeds));
  tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
    results[i] = simulate_faults(arguments.first_seed + i);
  });
  FaultSimulation all;
  all.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EventHash hash;
  for (FaultSimulationResult& result : results) {
    hash.add(result.hash);
    all.device_time_s += result.device_time_s;
    all.acquired_s += result.acquired_s;
    all.steps += result.steps;
    all.sticks += result.sticks_emitted;
    add(all.account, result.account);
    if (!result.failure.empty()) all.failed.push_back(std::move(result));
  }
  all.hash = hash.value();
  return all;
}

std::string hex(std::uint64_t value) {
  std::ostringstream text;
  text << std::hex << std::setw(16) << std::setfill('0') << value;
  return text.str();
}

std::string replay_command(std::uint64_t seed) {
  return "wobblebench rehearse --first-seed " + std::to_string(seed) + " --seeds 1 --trace";
}

Json to_report(const FaultSimulation& all, const CommandArguments& arguments) {
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  provenance.seed = arguments.first_seed;
  Json failures = Json::array();
  for (const auto& failed : all.failed) {
    failures.push_back(
        {{"seed", failed.seed}, {"rule", failed.failure}, {"replay", replay_command(failed.seed)}});
  }
  const auto& lost = all.account.lost;
  return {{"schema", kReportSchema},
          {"command", "rehearse"},
          {"provenance", to_json(provenance)},
          {"rehearsal",
           {{"seeds", arguments.seeds},
            {"first_seed", arguments.first_seed},
            {"hash", hex(all.hash)},
            {"steps", all.steps},
            {"sticks", all.sticks},
            {"emitted", all.account.emitted},
            {"delivered", all.account.delivered},
            {"lost",
             {{"ring_full", lost.ring_full},
              {"link", lost.link},
              {"corrupt", lost.corrupt},
              {"out_of_order", lost.out_of_order}}},
            {"device_time_s", all.device_time_s},
            {"wall_s", all.wall_s},
            {"times_real_time", all.device_time_s / all.wall_s},
            {"times_acquisition", all.acquired_s / all.wall_s},
            {"failures", failures}}}};
}

void print(const FaultSimulation& all, const CommandArguments& arguments) {
  const auto& lost = all.account.lost;
  std::cout << "rehearsed   seeds " << arguments.first_seed << " to "
            << arguments.first_seed + static_cast<std::uint64_t>(arguments.seeds) - 1 << ", "
            << all.steps << " steps, " << all.sticks << " sticks\n"
            << "account     " << all.account.emitted << " emitted, " << all.account.delivered
            << " delivered; lost: " << lost.ring_full << " ring_full, " << lost.link << " link, "
            << lost.corrupt << " corrupt, " << lost.out_of_order << " out_of_order\n"
            << "time        " << std::setprecision(4) << all.device_time_s
            << " s of device time in " << all.wall_s << " s: " << all.device_time_s / all.wall_s
            << " times real time, " << all.acquired_s / all.wall_s
            << " times the sticks' own acquisition\n"
            << "hash        " << hex(all.hash) << "\n"
            << "failures    " << all.failed.size() << "\n";
  for (const auto& failed : all.failed) {
    std::cout << "  seed " << failed.seed << ": " << failed.failure << "\n    "
              << replay_command(failed.seed) << "\n";
  }
}

}  // namespace

int rehearse_command(const CommandArguments& arguments) {
  OutputFolder out(arguments.out);
  if (arguments.trace) {
    for (int i = 0; i < arguments.seeds; ++i) {
      simulate_faults(arguments.first_seed + static_cast<std::uint64_t>(i),
                      [](const std::string& line) { std::cerr << line << "\n"; });
    }
  }
  const FaultSimulation all = rehearse_all(arguments);
  const Json report = to_report(all, arguments);
  out.write_text("report.json", report.dump(2) + "\n");
  out.commit();
  if (arguments.json) {
    std::cout << report.dump(2) << "\n";
  } else {
    print(all, arguments);
  }
  return all.failed.empty() ? 0 : 1;
}

}  // namespace wobblebench::bench
