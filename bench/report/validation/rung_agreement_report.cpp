#include <cmath>
#include <sstream>

#include "bench/report/validation/study_reports.h"
#include "hw/probe/probe.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeast = 0.98;
/// Main lobe alone: lower, as the side lobes are missing in tissue wider than the beam.
constexpr double kLeastMainLobe = 0.96;
/// Away from the foci pulses from the edges of the apertures arrive later than those from their
/// middle, which a table of one delay and one frequency slope does not reproduce.
constexpr double kLeastUnfocused = 0.95;

double least(bool side_lobes, double range_m) {
  const bool in_focus = std::abs(range_m / hw::ProbeOptions().transmit_focus_m - 1) < 0.1;
  if (!in_focus) return kLeastUnfocused;
  return side_lobes ? kLeast : kLeastMainLobe;
}

std::string text_of(const AgreementInputs& inputs) {
  std::ostringstream text;
  text << "A tile of tissue " << 1e3 * inputs.thickness_m << " mm thick and "
       << 2e3 * inputs.half_width_m << " mm wide in fluid, across the axis, seen by "
       << inputs.sticks << " sticks over " << inputs.sector_rad / kDegree
       << " degrees. Both rungs hear the same scatterers. `scatterers` looks up the beam in a "
          "table, its main lobe alone or with side lobes; `reference` sums over the elements, "
          "there and back, at each frequency of the band.";
  return text.str();
}

Check check(bool side_lobes, double range_m, double found, long n, std::uint64_t seed) {
  return {std::string("agreement.") + (side_lobes ? "side_lobes" : "main_lobe") + "_at_" +
              std::to_string(std::lround(range_m * 1e3)) + "mm",
          Check::Kind::at_least,
          found,
          least(side_lobes, range_m),
          0,
          "1",
          "correlation of envelopes with the sum over elements",
          n,
          "samples",
          {seed}};
}

}  // namespace

StudyReport rung_agreement_report(const AgreementInputs& inputs) {
  StudyReport report;
  report.id = "agreement";
  report.title = "Scatterers against reference";
  report.text = text_of(inputs);
  for (const double range_m : inputs.ranges_m) {
    const AgreementResult found = measure_agreement(range_m, inputs);
    report.checks.push_back(check(false, range_m, found.main_lobe, found.n, inputs.seed));
    report.checks.push_back(check(true, range_m, found.side_lobes, found.n, inputs.seed));
    const double mm = range_m * 1e3;
    report.points.push_back({"main_lobe", "range_mm", mm, "correlation", found.main_lobe, {}});
    report.points.push_back({"side_lobes", "range_mm", mm, "correlation", found.side_lobes, {}});
    report.points.push_back({"main_lobe", "range_mm", mm, "level_db", found.main_lobe_db, 0.0});
    report.points.push_back({"side_lobes", "range_mm", mm, "level_db", found.side_lobes_db, 0.0});
  }
  return report;
}

}  // namespace wobblebench::bench
