#include "bench/report/report_parts.h"

#include <nlohmann/json.hpp>

#include "hw/probe/clock.h"

namespace wobblebench::bench {

nlohmann::ordered_json acquisition_json(const hw::AcquisitionPlan& plan) {
  const auto& acquisition = plan.acquisition();
  return {{"volume_time_ms", hw::to_milliseconds(plan.volume_duration())},
          {"sticks", plan.sticks_per_volume()},
          {"frames", acquisition.frames_per_volume},
          {"samples", acquisition.samples_per_stick}};
}

}  // namespace wobblebench::bench
