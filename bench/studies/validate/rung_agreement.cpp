#include "bench/studies/validate/rung_agreement.h"

#include <cmath>
#include <sstream>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"

namespace wobblebench::bench {

namespace {

constexpr double kLeast = 0.98;
/// With the main lobe alone: what leaving out the side lobes costs in tissue wider than the beam.
constexpr double kLeastMainLobe = 0.96;
/// Away from both foci pulses from the apertures' edges come apart from those from their middle,
/// which a table of one delay and one slope over frequency does not follow.
constexpr double kLeastUnfocused = 0.95;

double least(bool side_lobes, double range_m) {
  const bool in_focus = std::abs(range_m / hw::ProbeOptions().transmit_focus_m - 1) < 0.1;
  if (!in_focus) return kLeastUnfocused;
  return side_lobes ? kLeast : kLeastMainLobe;
}

/// Beyond the tile on both sides: where its pulses end.
constexpr double kMargin_m = 1e-3;

Scan scan_tile(sim::Rung rung, double range_m, bool side_lobes, const AgreementInputs& inputs) {
  const double end_m = range_m + 0.5 * inputs.thickness_m + 2 * kMargin_m;
  const hw::AcquisitionPlan plan({},
                                 {.depth_m = end_m,
                                  .sector_rad = inputs.sector_rad,
                                  .sticks_per_frame = inputs.sticks,
                                  .samples_per_stick = static_cast<int>(end_m / 0.1e-3),
                                  .frames_per_volume = 1});
  auto options = lossless_envelope(rung, inputs.seed);
  options.side_lobes = side_lobes;
  const auto body =
      block({inputs.half_width_m, inputs.half_width_m, 0.5 * inputs.thickness_m}, 0.5e-3);
  return scan(phantoms::still_at(body, {0, 0, plan.probe().radius_m + range_m}), plan, options);
}

std::vector<double> within(const Scan& volume, double range_m, double half_m) {
  std::vector<double> values;
  for (int line = 0; line < volume.plan.acquisition().sticks_per_frame; ++line) {
    for (int k = volume.sample_at(range_m - half_m); k < volume.sample_at(range_m + half_m); ++k) {
      values.push_back(volume.at(0, line, k));
    }
  }
  return values;
}

double level_db(const std::vector<double>& values, const std::vector<double>& others) {
  double sum = 0, other_sum = 0;
  for (const double value : values) sum += value * value;
  for (const double value : others) other_sum += value * value;
  return 10 * std::log10(sum / other_sum);
}

std::string text_of(const AgreementInputs& inputs) {
  std::ostringstream text;
  text << "A tile of tissue " << 1e3 * inputs.thickness_m << " mm thick and "
       << 2e3 * inputs.half_width_m << " mm wide in fluid, across the axis, seen by "
       << inputs.sticks << " sticks over " << inputs.sector_rad / kDegree
       << " degrees. Both rungs hear the same scatterers. `scatterers` looks up the beam in a "
          "table, "
          "its main lobe alone or with side lobes; `reference` sums over the elements, there and "
          "back, "
          "at each frequency of the band.";
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

AgreementResult measure_agreement(double range_m, const AgreementInputs& inputs) {
  const double half_m = 0.5 * inputs.thickness_m + kMargin_m;
  const auto envelope = [&](sim::Rung rung, bool side_lobes) {
    return within(scan_tile(rung, range_m, side_lobes, inputs), range_m, half_m);
  };
  const auto reference = envelope(sim::Rung::reference, false);
  const auto main = envelope(sim::Rung::scatterers, false);
  const auto lobes = envelope(sim::Rung::scatterers, true);
  return {range_m,
          correlation(main, reference),
          correlation(lobes, reference),
          level_db(main, reference),
          level_db(lobes, reference),
          static_cast<long>(reference.size())};
}

StudyReport rung_agreement_study(const AgreementInputs& inputs) {
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
