// What is said of the sticks of a stream whose motor angles or times are not the plan's.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "bench/output/progress.h"
#include "hw/probe/motor_deviation.h"

namespace wobblebench::bench {

/// "angles leave the plan by at most 5.8 deg (RMS 4.2 deg)", and where the fan of the plan is
/// not covered, or left; empty: they are the plan's.
std::string motor_text(const hw::MotorDeviation& motor, const hw::AcquisitionPlan& plan);
/// Warns of sticks that are placed elsewhere than the plan has them.
void warn_of_motor(const hw::MotorDeviation& motor,
                   const hw::AcquisitionPlan& plan,
                   Progress& progress);
nlohmann::ordered_json motor_json(const hw::MotorDeviation& motor);

/// Warns of device times that leave the plan by `off_plan_s` where they matter: the truth of a
/// moving subject is that at the plan's times.
void warn_of_times(double off_plan_s,
                   const hw::AcquisitionPlan& plan,
                   bool subject_moves,
                   Progress& progress);

}  // namespace wobblebench::bench
