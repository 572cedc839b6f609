#include "bench/output/report_parts.h"

#include <unistd.h>

#include <climits>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "build_commit.h"
#include "hw/probe/clock.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

namespace {

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string host_name() {
  std::string name(HOST_NAME_MAX + 1, '\0');
  if (::gethostname(name.data(), name.size()) != 0) return "unknown";
  return name.substr(0, name.find('\0'));
}

}  // namespace

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json acquisition_json(const hw::AcquisitionPlan& plan, bool knows_times) {
  const auto& acquisition = plan.acquisition();
  const auto known = [&](double value) { return knows_times ? number(value) : nullptr; };
  return {{"line_rate_hz", known(1 / plan.stick_period_s())},
          {"volume_time_ms", known(to_milliseconds(plan.volume_duration()))},
          {"sticks", plan.sticks_per_volume()},
          {"frames", acquisition.frames_per_volume},
          {"samples", acquisition.samples_per_stick}};
}

nlohmann::ordered_json wall_json(const StepTimes& times) {
  nlohmann::ordered_json json;
  for (const auto& [name, ms] : times) json[name] = ms;
  return json;
}

std::string report_text(const nlohmann::ordered_json& report) {
  // A path may hold bytes that are no UTF-8: JSON has a replacement character for them.
  return report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

Provenance provenance_of_this_machine() {
  Provenance result;
  result.commit = kBuildCommit;
  result.host = host_name();
  result.cpu = cpu_model();
  result.threads = static_cast<int>(std::thread::hardware_concurrency());
  return result;
}

Provenance provenance_of_simulation(const render::GlContext& context, std::uint64_t seed) {
  Provenance result = provenance_of_this_machine();
  result.gl_backend = context.backend();
  result.gl_renderer = context.renderer_string();
  result.board = "simulated";
  result.seed = seed;
  return result;
}

std::string machine_text(const Provenance& provenance) {
  return provenance.cpu + ", " + std::to_string(provenance.threads) + " threads, " +
         provenance.gl_renderer;
}

std::string version_line(const std::string& program) {
  return program + " " + kBuildVersion + ", commit " + kBuildCommit;
}

nlohmann::ordered_json to_json(const Provenance& p) {
  const bool seeded = p.board.empty() || p.board == "simulated";
  return {{"commit", p.commit},
          {"host", p.host},
          {"cpu", p.cpu},
          {"threads", p.threads},
          {"gl_backend", p.gl_backend},
          {"gl_renderer", p.gl_renderer},
          {"board", p.board},
          {"seed", seeded ? nlohmann::ordered_json(p.seed) : nlohmann::ordered_json(nullptr)}};
}

}  // namespace wobblebench::bench
