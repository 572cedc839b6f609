// What every report says alike, whichever program writes it.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

inline constexpr int kReportSchema = 1;

nlohmann::ordered_json acquisition_json(const hw::AcquisitionPlan& plan);

}  // namespace wobblebench::bench
