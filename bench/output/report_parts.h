// What every report says alike, whichever program writes it.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

inline constexpr int kReportSchema = 1;

/// Names of steps with their wall time, ms.
using StepTimes = std::vector<std::pair<std::string, double>>;

/// Null unless it is finite: JSON has no NaN.
nlohmann::ordered_json number(double value);

nlohmann::ordered_json acquisition_json(const hw::AcquisitionPlan& plan);
nlohmann::ordered_json wall_json(const StepTimes& times);

/// The text of report.json.
std::string report_text(const nlohmann::ordered_json& report);

}  // namespace wobblebench::bench
