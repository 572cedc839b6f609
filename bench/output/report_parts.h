// What every report says alike, whichever program writes it.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::render {
class GlContext;
}

namespace wobblebench::bench {

inline constexpr int kReportSchema = 2;

/// Names of steps with their wall time, ms.
using StepTimes = std::vector<std::pair<std::string, double>>;

/// Null unless it is finite: JSON has no NaN.
nlohmann::ordered_json number(double value);

nlohmann::ordered_json acquisition_json(const hw::AcquisitionPlan& plan, bool knows_times = true);
nlohmann::ordered_json wall_json(const StepTimes& times);

/// The text of report.json.
std::string report_text(const nlohmann::ordered_json& report);

struct Provenance {
  std::string commit;  ///< of the build; "-dirty" when the tree had changes
  std::string host;
  std::string cpu;
  int threads = 0;
  std::string gl_backend;   ///< as --gl takes it; empty where nothing was rendered
  std::string gl_renderer;  ///< likewise
  std::string board;        ///< "simulated", "recording", "stand-in", "hardware"; empty: none used
  std::uint64_t seed = 0;   ///< reported as null where the sticks come from outside
};

/// Commit, host, CPU and threads; the caller fills in the rest.
Provenance provenance_of_this_machine();

/// All of it, of sticks simulated from this seed and rendered in this context.
Provenance provenance_of_simulation(const render::GlContext& context, std::uint64_t seed);

/// "CPU, 2 threads, GL_RENDERER": what times depend on, beside the program.
std::string machine_text(const Provenance& provenance);

/// "PROGRAM 0.1.0, commit 0123456789ab".
std::string version_line(const std::string& program);

nlohmann::ordered_json to_json(const Provenance& provenance);

}  // namespace wobblebench::bench
