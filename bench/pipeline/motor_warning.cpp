#include "bench/pipeline/motor_warning.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/number_text.h"
#include "bench/output/report_parts.h"

namespace wobblebench::bench {

namespace {

std::string degrees(double rad) {
  return significant(rad / kDegree, 3);
}

}  // namespace

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

void warn_of_times(double off_plan_s,
                   const hw::AcquisitionPlan& plan,
                   bool subject_moves,
                   Progress& progress) {
  if (!subject_moves || off_plan_s <= 0.5 * plan.stick_period_s()) return;
  progress.warn("device times leave the plan by up to " + significant(off_plan_s, 3) +
                " s; moving tissue is compared with where it is at the plan's times");
}

nlohmann::ordered_json motor_json(const hw::MotorDeviation& motor) {
  return {{"off_plan_max_deg", number(motor.max_rad / kDegree)},
          {"off_plan_rms_deg", number(motor.rms_rad() / kDegree)},
          {"least_deg", number(motor.low_rad / kDegree)},
          {"greatest_deg", number(motor.high_rad / kDegree)}};
}

}  // namespace wobblebench::bench
