// What is said of a scene and of the sticks that came where a picture may not be what was meant
// (Progress::warn).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bench/output/progress.h"
#include "bench/scene/idle_options.h"
#include "hw/probe/motor_deviation.h"

namespace wobblebench::bench {

/// A correction for the beam's width that was determined for another probe, receiver or rung, and a
/// single frame, which fills its fan.
std::vector<std::string> scene_warnings(const Scene& scene, SampleSource source);
/// Warns of those, and of options that were given and are without effect.
void warn_of_scene(const Scene& scene, SampleSource source, Progress& progress);

/// "angles leave the plan by at most 5.8 deg (RMS 4.2 deg)", and where the fan of the plan is
/// not covered, or left; empty: they are the plan's.
std::string motor_text(const hw::MotorDeviation& motor, const hw::AcquisitionPlan& plan);
/// Warns of sticks that are placed elsewhere than the plan has them.
void warn_of_motor(const hw::MotorDeviation& motor,
                   const hw::AcquisitionPlan& plan,
                   Progress& progress);
nlohmann::ordered_json motor_json(const hw::MotorDeviation& motor);

}  // namespace wobblebench::bench
