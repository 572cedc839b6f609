#include "bench/studies/validate/rung_agreement.h"

#include <cmath>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "bench/studies/validate/statistics.h"

namespace wobblebench::bench {

namespace {

/// Margin in range on both sides of the tile, for the length of the pulse.
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

}  // namespace wobblebench::bench
