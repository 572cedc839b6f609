#include "bench/pipeline/scene_warnings.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/number_text.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

std::string degrees(double rad) {
  return significant(rad / kDegree, 3);
}

bool is_default_receiver(const sim::SimulationOptions& o) {
  const sim::SimulationOptions standard;
  return o.full_scale_db == standard.full_scale_db &&
         o.dynamic_range_db == standard.dynamic_range_db &&
         o.tgc_db_per_cm_mhz == standard.tgc_db_per_cm_mhz;
}

/// What differs from the scans that the correction was determined on; empty: nothing.
std::string other_than_determined(const Scene& scene, SampleSource source) {
  if (source == SampleSource::unknown_subject) return "the samples are not simulated";
  const bool is_geometry = scene.simulation.fidelity == sim::Rung::geometry;
  if (source == SampleSource::simulator && is_geometry)
    return "the rung geometry has no beam width";
  if (static_cast<const hw::ProbeOptions&>(scene.probe) != hw::ProbeOptions{}) {
    return "the probe is another";
  }
  return is_default_receiver(scene.simulation) ? "" : "the receiver is another";
}

/// Empty: there is nothing to say of it.
std::string incidence_text(const Scene& scene, SampleSource source) {
  const std::string key = "render.ray_casting.incidence_correction_mm";
  const render::RayCastingOptions& o = scene.render.ray_casting;
  const bool acts = o.incidence_correction_m > 0 && o.mode != render::RenderMode::volume;
  if (!acts || scene.given.contains(key)) return "";
  const std::string other = other_than_determined(scene, source);
  if (other.empty()) return "";
  return key + " = " + significant(o.incidence_correction_m / kMillimetre, 3) +
         " was determined for the default simulated probe, and " + other +
         ": steep surfaces may lie too deep; give the key a value (0: no correction)";
}

/// Empty: there are several frames.
std::string one_frame_text(const Scene& scene) {
  if (scene.acquisition.frames_per_volume > 1) return "";
  return "acquisition.frames_per_volume = 1: the picture shows the one plane all over the fan of " +
         degrees(scene.acquisition.fan_rad) +
         " deg, as if the body were the same at every motor angle";
}

}  // namespace

std::vector<std::string> scene_warnings(const Scene& scene, SampleSource source) {
  std::vector<std::string> warnings;
  for (std::string text : {incidence_text(scene, source), one_frame_text(scene)}) {
    if (!text.empty()) warnings.push_back(std::move(text));
  }
  return warnings;
}

void warn_of_scene(const Scene& scene, SampleSource source, Progress& progress) {
  for (const std::string& text : scene_warnings(scene, source)) progress.warn(text);
  progress.warn(idle_options_text(idle_options(scene, scene.given, source)));
}

std::string motor_text(const hw::MotorDeviation& motor, const hw::AcquisitionPlan& plan) {
  if (!motor.matters(plan)) return "";
  std::string text = "angles leave the plan by at most " + degrees(motor.max_rad) + " deg (RMS " +
                     degrees(motor.rms_rad()) + " deg)";
  const auto [low_rad, high_rad] = hw::planned_fan_rad(plan);
  const double much_rad = hw::negligible_deviation_rad(plan);
  const bool same = std::abs(motor.low_rad - low_rad) <= much_rad &&
                    std::abs(motor.high_rad - high_rad) <= much_rad;
  if (same) return text;
  return text + "; they go from " + degrees(motor.low_rad) + " to " + degrees(motor.high_rad) +
         " deg, the plan's fan from " + degrees(low_rad) + " to " + degrees(high_rad) + " deg";
}

void warn_of_motor(const hw::MotorDeviation& motor,
                   const hw::AcquisitionPlan& plan,
                   Progress& progress) {
  const std::string text = motor_text(motor, plan);
  if (text.empty() || plan.acquisition().frames_per_volume == 1) return;
  const auto [low_rad, high_rad] = hw::planned_fan_rad(plan);
  const double much_rad = hw::negligible_deviation_rad(plan);
  const bool beyond = motor.low_rad < low_rad - much_rad || motor.high_rad > high_rad + much_rad;
  progress.warn("motor " + text + ": sticks are placed by their own angles" +
                (beyond ? ", those beyond the plan's fan left out" : ""));
}

nlohmann::ordered_json motor_json(const hw::MotorDeviation& motor) {
  return {{"off_plan_max_deg", number(motor.max_rad / kDegree)},
          {"off_plan_rms_deg", number(motor.rms_rad() / kDegree)},
          {"least_deg", number(motor.low_rad / kDegree)},
          {"greatest_deg", number(motor.high_rad / kDegree)}};
}

}  // namespace wobblebench::bench
