#include "bench/cli/fault_simulation_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <sstream>

#include "bench/cli/board_report.h"
#include "bench/output/provenance.h"
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

}  // namespace

std::string fault_simulation_report(const SeedRangeResult& all) {
  Provenance provenance = provenance_of_this_machine();
  provenance.board = "simulated";
  provenance.seed = all.first_seed;
  Json failures = Json::array();
  for (const auto& failed : all.failed) {
    failures.push_back(
        {{"seed", failed.seed}, {"rule", failed.failure}, {"replay", replay_command(failed.seed)}});
  }
  Json lost;
  for (const auto& [cause, count] : losses_by_cause(all.account)) lost[cause] = count;
  const Json report = {{"schema", kReportSchema},
                       {"command", "rehearse"},
                       {"provenance", to_json(provenance)},
                       {"rehearsal",
                        {{"seeds", all.seeds},
                         {"first_seed", all.first_seed},
                         {"hash", hex(all.hash)},
                         {"steps", all.steps},
                         {"sticks", all.sticks},
                         {"emitted", all.account.emitted},
                         {"delivered", all.account.delivered},
                         {"lost", lost},
                         {"bytes_recorded", all.bytes_recorded},
                         {"sticks_salvaged", all.sticks_salvaged},
                         {"device_time_s", all.device_time_s},
                         {"wall_s", all.wall_s},
                         {"times_real_time", all.device_time_s / all.wall_s},
                         {"times_acquisition", all.acquired_s / all.wall_s},
                         {"failures", failures}}}};
  return report_text(report);
}

std::string fault_simulation_summary(const SeedRangeResult& all) {
  std::ostringstream text;
  const auto& lost = all.account.lost;
  text << "rehearsed   seeds " << all.first_seed << " to "
       << all.first_seed + static_cast<std::uint64_t>(all.seeds) - 1 << ", " << all.steps
       << " steps, " << all.sticks << " sticks\n"
       << "account     " << all.account.emitted << " emitted, " << all.account.delivered
       << " delivered; lost: " << lost.ring_full << " ring_full, " << lost.link << " link, "
       << lost.corrupt << " corrupt, " << lost.out_of_order << " out_of_order\n"
       << "recordings  " << all.bytes_recorded << " bytes recorded, killed anywhere, "
       << all.sticks_salvaged << " sticks salvaged\n"
       << "time        " << std::setprecision(4) << all.device_time_s << " s of device time in "
       << all.wall_s << " s: " << all.device_time_s / all.wall_s << " times real time, "
       << all.acquired_s / all.wall_s << " times the sticks' own acquisition\n"
       << "hash        " << hex(all.hash) << "\n"
       << "failures    " << all.failed.size() << "\n";
  for (const auto& failed : all.failed) {
    text << "  seed " << failed.seed << ": " << failed.failure << "\n    "
         << replay_command(failed.seed) << "\n";
  }
  return text.str();
}

}  // namespace wobblebench::bench
