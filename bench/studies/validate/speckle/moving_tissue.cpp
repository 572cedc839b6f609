#include "bench/studies/validate/speckle/moving_tissue.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>

#include "base/duration.h"
#include "base/statistics.h"
#include "bench/studies/validate/common/scan.h"
#include "bench/studies/validate/common/statistics.h"
#include "sim/fidelity.h"

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

Chart shear_chart(const ShearResult& result) {
  Chart chart{
      "Front of a moving sphere, middle stick of each frame", {"device time (ms)"}, {"range (mm)"}};
  Series expected{"closed form", {}, {}, Stroke::solid, Mark::none, 6};
  Series still{"were it still", {}, {}, Stroke::dashed, Mark::none, 1};
  Series found{"geometry", {}, {}, Stroke::none, Mark::disc, 0};
  for (const auto& at : result.middle) {
    expected.add(at.time_s * 1e3, at.expected_m * 1e3);
    still.add(at.time_s * 1e3, at.still_m * 1e3);
    found.add(at.time_s * 1e3, at.found_m * 1e3);
  }
  chart.series = {still, expected, found};
  return chart;
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
           {shear_chart(result)}});
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

namespace {

constexpr double kDepth_m = 0.09;
constexpr double kFrom_m = 45e-3;
constexpr double kTo_m = 85e-3;
constexpr double kMiddle_m = 75e-3;
/// Time between sticks, so that the velocities stay within the limits of MotionOptions.
constexpr double kDeadTime_s = 1e-3;

hw::AcquisitionOptions common(const SpeckleMotionInputs& inputs) {
  hw::AcquisitionOptions acquisition{.depth_m = kDepth_m,
                                     .sector_rad = 60 * kDegree,
                                     .sticks_per_frame = 1,
                                     .samples_per_stick = inputs.samples,
                                     .frames_per_volume = 1,
                                     .volumes = 2};
  acquisition.dead_time_s = kDeadTime_s;
  return acquisition;
}

/// From a sample of the second volume back to the same tissue in the first, in indices.
struct IndexShift {
  int frames = 0;
  int sticks = 0;
  int samples = 0;
};

struct Setup {
  std::string motion;
  double shift_mm;
  hw::AcquisitionPlan plan;
  phantoms::Placement placement;
  phantoms::MotionOptions motion_options;
  IndexShift shift;
};

/// A few sticks within 2 degrees of the axis, so that motion along the axis is motion along them to
/// within 1/30 of its length.
Setup along_axis(const SpeckleMotionInputs& inputs) {
  auto acquisition = common(inputs);
  acquisition.sector_rad = acquisition.fan_rad = 4 * kDegree;
  acquisition.sticks_per_frame = acquisition.frames_per_volume = 3;
  const hw::AcquisitionPlan plan({}, acquisition);
  const double shift_m = inputs.axial_shift * plan.sample_spacing_m();
  Setup setup{"axial", 1e3 * shift_m, plan, {}, {}, {0, 0, inputs.axial_shift}};
  setup.motion_options.velocity_m_s = {0, 0, shift_m / to_seconds(plan.volume_duration())};
  return setup;
}

/// Stick l + 1 of the next volume is fired one volume and one stick after stick l; the tissue
/// rotates meanwhile by the angle between them, about the centre of curvature.
Setup in_plane(const SpeckleMotionInputs& inputs) {
  auto acquisition = common(inputs);
  acquisition.sticks_per_frame = inputs.sticks;
  const hw::AcquisitionPlan plan({}, acquisition);
  const double later_s = to_seconds(plan.volume_duration()) + plan.stick_period_s();
  Setup setup{"in the image plane",
              1e3 * (plan.probe().radius_m + kMiddle_m) * plan.theta_step_rad(),
              plan,
              {},
              {},
              {0, 1, 0}};
  setup.motion_options.turn_rate_rad_s = {0, plan.theta_step_rad() / later_s, 0};
  return setup;
}

/// The same for frames, about the motor's axis.
Setup across_planes(const SpeckleMotionInputs& inputs) {
  auto acquisition = common(inputs);
  acquisition.frames_per_volume = inputs.frames;
  const hw::AcquisitionPlan plan({}, acquisition);
  const double later_s = to_seconds(plan.volume_duration()) + plan.stick_period_s();
  const double axis_z_m = plan.geometry().axis_z_m();
  Setup setup{"across image planes",
              1e3 * (plan.probe().radius_m + kMiddle_m - axis_z_m) * plan.phi_step_rad(),
              plan,
              {glm::dmat3(1.0), {0, 0, axis_z_m}},
              {},
              {1, 0, 0}};
  setup.motion_options.turn_rate_rad_s = {plan.phi_step_rad() / later_s, 0, 0};
  return setup;
}

MotionResult measure(const Setup& setup, sim::Rung rung, std::uint64_t seed) {
  const sim::ProbeSimulator simulator(
      {open_tissue(), setup.placement, phantoms::Motion(setup.motion_options, {})},
      setup.plan,
      lossless_envelope(rung, seed));
  const Scan first{setup.plan, simulator.volume(0)}, second{setup.plan, simulator.volume(1)};
  const auto& a = setup.plan.acquisition();
  std::vector<double> now, followed, here, stayed;
  for (int f = 0; f < a.frames_per_volume; ++f) {
    for (int l = 0; l < a.sticks_per_frame; ++l) {
      for (int k = first.sample_at(kFrom_m); k < first.sample_at(kTo_m); ++k) {
        here.push_back(second.at(f, l, k));
        stayed.push_back(first.at(f, l, k));
        if (f < setup.shift.frames || l < setup.shift.sticks) continue;
        now.push_back(second.at(f, l, k));
        followed.push_back(
            first.at(f - setup.shift.frames, l - setup.shift.sticks, k - setup.shift.samples));
      }
    }
  }
  return {setup.motion,
          setup.shift_mm,
          correlation(now, followed),
          correlation(here, stayed),
          static_cast<long>(now.size())};
}

}  // namespace

std::vector<MotionResult> measure_speckle_motion(sim::Rung rung,
                                                 const SpeckleMotionInputs& inputs) {
  std::vector<MotionResult> results;
  for (const auto& setup : {along_axis(inputs), in_plane(inputs), across_planes(inputs)}) {
    results.push_back(measure(setup, rung, inputs.seed));
  }
  return results;
}

namespace {

constexpr double kLeast = 0.95;

}  // namespace

StudyReport speckle_motion_report() {
  const SpeckleMotionInputs inputs;
  StudyReport report;
  Table table{.name = "speckle_motion",
              .columns = {{"rung"},
                          {"motion"},
                          {"shift_mm", "shift at 75 mm", "mm", 3},
                          {"followed", "correlation at the place it moved to", "", 4},
                          {"stayed", "at the place it was", "", 4}}};
  for (const sim::Rung rung : {sim::Rung::scatterers, sim::Rung::field}) {
    for (const MotionResult& found : measure_speckle_motion(rung, inputs)) {
      const std::string series = sim::to_string(rung) + ", " + found.motion;
      table.add({sim::to_string(rung), found.motion, found.shift_mm, found.followed, found.stayed});
      report.point(series, {"shift_mm", found.shift_mm}, {"correlation_followed", found.followed});
      report.point(series, {"shift_mm", found.shift_mm}, {"correlation_stayed", found.stayed});
      if (rung == sim::Rung::field) continue;
      std::string name = found.motion;
      std::replace(name.begin(), name.end(), ' ', '_');
      report.check("speckle_motion.scatterers." + name)
          .at_least(found.followed, kLeast, "1")
          .from("the same tissue, seen again where it moved to")
          .over(found.n, "samples", {inputs.seed});
    }
  }
  report.text =
      "Tissue moves so that in the second volume each stick sees exactly what it, or its "
      "neighbour, saw in the first: along the axis by whole samples; in the image plane by one "
      "stick; across image planes by one frame. The time from one look to the other is that of the "
      "sticks themselves. `field`'s speckle belongs to the probe's grid and stays where it is: it "
      "is here for contrast, and is why `auto` takes `scatterers` for a phantom that moves.";
  report.tables = {table};
  return report;
}

}  // namespace wobblebench::bench
