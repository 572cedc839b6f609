#include <algorithm>
#include <cmath>

#include "bench/studies/validate/study_reports.h"
#include "sim/fidelity.h"

namespace wobblebench::bench {

namespace {

constexpr double kSlopeTolerance = 0.02;
constexpr double kLevelTolerance_db = 1;
/// Every how many samples or bins there is a mark.
constexpr std::size_t kSlopeMarks = 16;

void add_slope(const std::string& name,
               const SlopeResult& found,
               const AttenuationInputs& inputs,
               StudyReport& report,
               Chart& chart) {
  report.checks.push_back({"attenuation.slope." + name,
                           Check::Kind::within,
                           found.slope_db_per_cm,
                           found.expected_db_per_cm,
                           kSlopeTolerance * std::abs(found.expected_db_per_cm),
                           "dB/cm",
                           "a line through -n + n^2 s^2 / 2, n = 2 alpha f r, of soft_tissue",
                           found.n,
                           "samples",
                           inputs.seeds});
  Series series{name, {}, {}, Stroke::none, chart.series.empty() ? Mark::disc : Mark::ring};
  for (std::size_t i = 0; i < found.range_m.size(); ++i) {
    report.points.push_back({"slope " + name,
                             "range_mm",
                             found.range_m[i] * 1e3,
                             "level_db",
                             found.level_db[i],
                             found.expected_db[i]});
    if (i % kSlopeMarks != 0) continue;
    series.x.push_back(found.range_m[i] * 1e3);
    series.y.push_back(found.level_db[i]);
  }
  chart.series.push_back(series);
}

void add_body(const std::string& body,
              const std::string& rung,
              const ShadowResult& found,
              const AttenuationInputs& inputs,
              StudyReport& report,
              Chart& chart) {
  report.checks.push_back(
      {"attenuation." + body + "." + rung,
       Check::Kind::within,
       found.behind_db,
       found.expected_behind_db,
       kLevelTolerance_db,
       "dB",
       "attenuation of the band on the way through it, and (1 - R^2) of its faces, there and back",
       found.n,
       "samples",
       inputs.seeds});
  const bool first = chart.series.empty();
  Series measured{rung, {}, {}, Stroke::none, first ? Mark::disc : Mark::ring, first ? 0 : 1};
  Series expected{first ? "closed form" : "", {}, {}, Stroke::solid, Mark::none, 6};
  for (std::size_t i = 0; i < found.range_m.size(); ++i) {
    const double mm = found.range_m[i] * 1e3;
    report.points.push_back(
        {body + " " + rung, "range_mm", mm, "change_db", found.change_db[i], found.expected_db[i]});
    if (mm < 20) continue;
    expected.x.push_back(mm);
    expected.y.push_back(found.expected_db[i]);
    if (i % 2 != 0 || !std::isfinite(found.expected_db[i])) continue;
    measured.x.push_back(mm);
    measured.y.push_back(found.change_db[i]);
  }
  if (first) chart.series.push_back(expected);
  chart.series.push_back(measured);
}

}  // namespace

StudyReport attenuation_report(const AttenuationInputs& inputs) {
  StudyReport report;
  report.id = "attenuation";
  report.title = "Attenuation, shadow, enhancement";
  Chart slope{"Even tissue", {"range (mm)"}, {"mean intensity (dB against a mirror)"}};
  add_slope("field_without_speckle",
            measure_slope(sim::Rung::field, false, inputs),
            inputs,
            report,
            slope);
  Chart shadow{"Behind 3 mm of bone", {"range (mm)"}, {"change of mean intensity (dB)"}};
  Chart enhancement{"Behind a cyst of 40 mm", {"range (mm)"}, {"change of mean intensity (dB)"}};
  for (const sim::Rung rung : {sim::Rung::field, sim::Rung::scatterers}) {
    const std::string name = sim::to_string(rung);
    add_slope(name, measure_slope(rung, true, inputs), inputs, report, slope);
    add_body("bone_shadow", name, measure_bone_shadow(rung, inputs), inputs, report, shadow);
    add_body("cyst_enhancement",
             name,
             measure_cyst_enhancement(rung, inputs),
             inputs,
             report,
             enhancement);
  }
  report.figures.push_back({"attenuation_slope",
                            "Mean intensity of even tissue, no time gain.",
                            draw(slope, {700, 360})});
  report.figures.push_back(
      {"attenuation_shadow",
       "Left: behind the phantom bone_plate. Right: behind the phantom cyst. Both against the same "
       "tissue without it.",
       side_by_side({draw(shadow, {560, 360}), draw(enhancement, {560, 360})})});
  report.text =
      "Linear envelope, no time gain, no noise, no interface echoes. Slope: even soft tissue, the "
      "mean intensity over all sticks at each range, a line through its logarithm from 20 to 120 "
      "mm; attenuation grows with frequency, so that of the band's n nepers at its centre, "
      "n^2 s^2 / 2 remain (s: its relative standard deviation). Bone and cyst: sticks within 3 "
      "degrees of the axis, mean intensity from 2 to 30 mm "
      "behind the body over that of the same tissue without it; the closed form takes each stick's "
      "own way through the body, and reflection at normal incidence.";
  return report;
}

}  // namespace wobblebench::bench
