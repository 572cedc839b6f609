#include "bench/output/report_parts.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "hw/probe/clock.h"

namespace wobblebench::bench {

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json acquisition_json(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  return {{"volume_time_ms", to_milliseconds(plan.volume_duration())},
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

}  // namespace wobblebench::bench
