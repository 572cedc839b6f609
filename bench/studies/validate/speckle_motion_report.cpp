#include <algorithm>
#include <sstream>

#include "bench/studies/validate/study_reports.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeast = 0.95;

}  // namespace

StudyReport speckle_motion_report(const SpeckleMotionInputs& inputs) {
  StudyReport report;
  report.id = "speckle_motion";
  report.title = "Speckle moves with the tissue";
  std::ostringstream table;
  table << "| rung | motion | shift at 75 mm | correlation at the place it moved to | at the place "
           "it was |\n| --- | --- | ---: | ---: | ---: |\n";
  for (const sim::Rung rung : {sim::Rung::scatterers, sim::Rung::field}) {
    for (const MotionResult& found : measure_speckle_motion(rung, inputs)) {
      const std::string series = sim::to_string(rung) + ", " + found.motion;
      table << "| " << sim::to_string(rung) << " | " << found.motion << " | " << found.shift_mm
            << " mm | " << found.followed << " | " << found.stayed << " |\n";
      report.points.push_back(
          {series, "shift_mm", found.shift_mm, "correlation_followed", found.followed, {}});
      report.points.push_back(
          {series, "shift_mm", found.shift_mm, "correlation_stayed", found.stayed, {}});
      if (rung == sim::Rung::field) continue;
      std::string name = found.motion;
      std::replace(name.begin(), name.end(), ' ', '_');
      report.checks.push_back({"speckle_motion.scatterers." + name,
                               Check::Kind::at_least,
                               found.followed,
                               kLeast,
                               0,
                               "1",
                               "the same tissue, seen again where it moved to",
                               found.n,
                               "samples",
                               {inputs.seed}});
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
