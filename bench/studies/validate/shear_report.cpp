#include "bench/studies/validate/study_reports.h"

namespace wobblebench::bench {

namespace {

Picture3 draw_shear(const ShearResult& result) {
  Chart chart{
      "Front of a moving sphere, middle stick of each frame", {"device time (ms)"}, {"range (mm)"}};
  Series expected{"closed form"}, still{"were it still"};
  Series found{"geometry", {}, {}, Stroke::none, Mark::disc, 0};
  expected.colour = 6;
  still.colour = 1;
  still.stroke = Stroke::dashed;
  for (const auto& at : result.middle) {
    for (Series* series : {&expected, &still, &found}) series->x.push_back(at.time_s * 1e3);
    expected.y.push_back(at.expected_m * 1e3);
    still.y.push_back(at.still_m * 1e3);
    found.y.push_back(at.found_m * 1e3);
  }
  chart.series = {still, expected, found};
  return draw(chart, {680, 360});
}

}  // namespace

StudyReport shear_report(const ShearInputs& inputs) {
  StudyReport report;
  report.id = "shear";
  report.title = "A moving sphere is sheared";
  for (const ShearResult& result : measure_shear(inputs)) {
    report.checks.push_back({"shear." + result.motion,
                             Check::Kind::at_most,
                             result.largest_error_m * 1e3,
                             result.allowed_m * 1e3,
                             0,
                             "mm",
                             "half a sample, and 0.005 mm for the phantom's grid",
                             result.n,
                             "sticks",
                             {}});
    const std::string name = result.motion;
    report.points.push_back({name,
                             "sticks",
                             static_cast<double>(result.n),
                             "mean_error_mm",
                             result.mean_error_m * 1e3,
                             {}});
    report.points.push_back({name,
                             "sticks",
                             static_cast<double>(result.n),
                             "largest_shear_mm",
                             result.largest_shear_m * 1e3,
                             {}});
    for (const auto& at : result.middle) {
      report.points.push_back(
          {name, "time_ms", at.time_s * 1e3, "range_mm", at.found_m * 1e3, at.expected_m * 1e3});
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
