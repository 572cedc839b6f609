#include "bench/studies/validate/speckle_motion.h"

#include <algorithm>
#include <chrono>
#include <sstream>

#include "base/statistics.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kDepth_m = 0.09;
constexpr double kFrom_m = 45e-3;
constexpr double kTo_m = 85e-3;
constexpr double kMiddle_m = 75e-3;
/// Time between sticks, so that the velocities stay within the limits of MotionOptions.
constexpr double kDeadTime_s = 1e-3;

double seconds(hw::DeviceDuration duration) {
  return std::chrono::duration<double>(duration).count();
}

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
  setup.motion_options.velocity_m_s = {0, 0, shift_m / seconds(plan.volume_duration())};
  return setup;
}

/// Stick l + 1 of the next volume is fired one volume and one stick after stick l; the tissue
/// rotates meanwhile by the angle between them, about the centre of curvature.
Setup in_plane(const SpeckleMotionInputs& inputs) {
  auto acquisition = common(inputs);
  acquisition.sticks_per_frame = inputs.sticks;
  const hw::AcquisitionPlan plan({}, acquisition);
  const double later_s = seconds(plan.volume_duration()) + plan.stick_period_s();
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
  const double later_s = seconds(plan.volume_duration()) + plan.stick_period_s();
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
  std::ostringstream table;
  table << "| rung | motion | shift at 75 mm | correlation at the place it moved to | at the place "
           "it was |\n| --- | --- | ---: | ---: | ---: |\n";
  for (const sim::Rung rung : {sim::Rung::scatterers, sim::Rung::field}) {
    for (const MotionResult& found : measure_speckle_motion(rung, inputs)) {
      const std::string series = sim::to_string(rung) + ", " + found.motion;
      table << "| " << sim::to_string(rung) << " | " << found.motion << " | " << found.shift_mm
            << " mm | " << found.followed << " | " << found.stayed << " |\n";
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
      "is here for contrast, and is why `auto` takes `scatterers` for a phantom that moves.\n\n" +
      table.str();
  return report;
}

}  // namespace wobblebench::bench
