#include "bench/studies/validate/shear.h"

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>

#include "bench/studies/validate/scan.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeastCosine = 0.5;
/// Rounding of the distance to a sphere of 20 mm on a grid of 0.5 mm, at 60 degrees.
constexpr double kGridRounding_m = 5e-6;

struct Case {
  std::string name;
  hw::MotorMode motor;
  std::uint32_t volume;
  phantoms::MotionOptions motion;
  std::function<glm::dvec3(double)> displacement_m;  ///< closed form
};

std::vector<Case> cases() {
  const glm::dvec3 velocity{6e-3, -8e-3, 10e-3};
  phantoms::MotionOptions path;
  path.velocity_m_s = velocity;
  const auto along_path = [=](double t) { return velocity * t; };
  phantoms::MotionOptions breath;
  breath.breath_amplitude_m = 5e-3;
  breath.breath_period_s = 0.7;
  const auto breathing = [=](double t) {
    return glm::dvec3(0, 5e-3 * std::sin(2 * kPi * t / 0.7), 0);
  };
  return {{"path", hw::MotorMode::stepped, 0, path, along_path},
          {"path_sweeping_back", hw::MotorMode::alternating, 1, path, along_path},
          {"breath", hw::MotorMode::continuous, 0, breath, breathing}};
}

/// Distance along the ray to the front of a sphere; none where the incidence exceeds 60 degrees.
std::optional<double> front_m(const hw::Ray& ray, const glm::dvec3& center, double radius_m) {
  const double middle = glm::dot(center - ray.origin, ray.direction);
  const double aside = glm::length(center - ray.at(middle));
  if (!(aside < radius_m * std::sqrt(1 - kLeastCosine * kLeastCosine))) return std::nullopt;
  return middle - std::sqrt(radius_m * radius_m - aside * aside);
}

/// Lower bound of the first sample above zero.
std::optional<double> found_m(const Scan& volume, int frame, int line) {
  for (int k = 0; k < volume.plan.acquisition().samples_per_stick; ++k) {
    if (volume.at(frame, line, k) > 0) return k * volume.plan.sample_spacing_m();
  }
  return std::nullopt;
}

ShearResult measure(const Case& moving, const ShearInputs& inputs) {
  const phantoms::PhantomOptions sphere{.name = "sphere"};
  const auto phantom = phantoms::make_phantom(sphere);
  const glm::dvec3 center = phantom.suggested_position_m();
  hw::AcquisitionOptions acquisition{.sticks_per_frame = inputs.sticks,
                                     .samples_per_stick = inputs.samples,
                                     .frames_per_volume = inputs.frames,
                                     .volumes = 2};
  acquisition.motor = moving.motor;
  const hw::AcquisitionPlan plan({}, acquisition);
  sim::SimulationOptions options;
  options.fidelity = sim::Rung::geometry;
  auto subject = phantoms::still_at(phantom, center);
  subject.motion = phantoms::Motion(moving.motion, phantom.joint());
  const Scan volume = scan(subject, plan, options, moving.volume);

  ShearResult result;
  result.motion = moving.name;
  result.allowed_m = 0.5 * plan.sample_spacing_m() + kGridRounding_m;
  const double period_s = 2 * acquisition.depth_m / acquisition.sound_speed_m_s;
  const std::uint64_t first = plan.first_sequence(moving.volume);
  for (int stick = 0; stick < plan.sticks_per_volume(); ++stick) {
    const std::uint64_t sequence = first + static_cast<std::uint64_t>(stick);
    const auto index = plan.index(sequence);
    const int line = static_cast<int>(index.line);
    const double time_s = static_cast<double>(sequence) * period_s;
    const auto ray = plan.geometry().stick(plan.theta_rad(line), plan.motor_angle_rad(index));
    const auto expected = front_m(ray, center + moving.displacement_m(time_s), sphere.radius_m);
    if (!expected) continue;
    // Samples of a volume lie in the order of their sequence numbers.
    const auto found = found_m(volume, stick / inputs.sticks, stick % inputs.sticks);
    const auto still = front_m(ray, center, sphere.radius_m);
    const double error = found ? std::abs(*found - *expected) : acquisition.depth_m;
    const double shear = still ? std::abs(*still - *expected) : 0;
    result.largest_error_m = std::max(result.largest_error_m, error);
    result.largest_shear_m = std::max(result.largest_shear_m, shear);
    result.mean_error_m += error;
    ++result.n;
    if (line == inputs.sticks / 2 && found && still) {
      result.middle.push_back({time_s, *found, *expected, *still});
    }
  }
  result.mean_error_m /= static_cast<double>(result.n);
  return result;
}

}  // namespace

std::vector<ShearResult> measure_shear(const ShearInputs& inputs) {
  std::vector<ShearResult> results;
  for (const Case& moving : cases()) results.push_back(measure(moving, inputs));
  return results;
}

namespace {

Picture3 draw_shear(const ShearResult& result) {
  Chart chart{
      "Front of a moving sphere, middle stick of each frame", {"device time (ms)"}, {"range (mm)"}};
  Series expected{"closed form", {}, {}, Stroke::solid, Mark::none, 6};
  Series still{"were it still", {}, {}, Stroke::dashed, Mark::none, 1};
  Series found{"geometry", {}, {}, Stroke::none, Mark::disc, 0};
  for (const auto& at : result.middle) {
    add_to(expected, at.time_s * 1e3, at.expected_m * 1e3);
    add_to(still, at.time_s * 1e3, at.still_m * 1e3);
    add_to(found, at.time_s * 1e3, at.found_m * 1e3);
  }
  chart.series = {still, expected, found};
  return draw(chart, {680, 360});
}

}  // namespace

StudyReport shear_report() {
  const ShearInputs inputs;
  StudyReport report;
  for (const ShearResult& result : measure_shear(inputs)) {
    report.check("shear." + result.motion)
        .at_most(result.largest_error_m * 1e3, result.allowed_m * 1e3, "mm")
        .from("half a sample, and 0.005 mm for the phantom's grid")
        .over(result.n, "sticks");
    const std::string name = result.motion;
    const StudyReport::X sticks{"sticks", static_cast<double>(result.n)};
    report.point(name, sticks, {"mean_error_mm", result.mean_error_m * 1e3});
    report.point(name, sticks, {"largest_shear_mm", result.largest_shear_m * 1e3});
    for (const auto& at : result.middle) {
      report.point(
          name, {"time_ms", at.time_s * 1e3}, {"range_mm", at.found_m * 1e3, at.expected_m * 1e3});
    }
    if (report.figures.empty()) {
      report.figures.push_back(
          {"shear",
           "A sphere that moves by (6, -8, 10) mm/s, found by the rung geometry.",
           draw_shear(result)});
    }
  }
  report.text =
      "A sphere of 20 mm on a straight path at 14 mm/s, seen by a motor that steps, and by one "
      "that sweeps back; and one that breathes while the motor turns. Stick number n looks at n "
      "times 2 d / c. Its front is where the first sample shows tissue; the closed form is a line "
      "through a ball whose centre the motion's formula gives at that time. A still sphere would "
      "be wrong by up to the shear in the CSV file.";
  return report;
}

}  // namespace wobblebench::bench
