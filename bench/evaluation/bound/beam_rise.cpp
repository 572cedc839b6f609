#include "bench/evaluation/bound/beam_rise.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "sim/beam/profile/beam_at_samples.h"

namespace wobblebench::bench {

namespace {

constexpr double kBin_m = 10e-6;

/// Power of the beam by how much later than the axis it meets the surface.
struct Part {
  double later_m = 0;
  double power = 0;
};

double power_of(const sim::BandValues& value) {
  sim::PulseBand::Values values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = {value.re[i], value.im[i]};
  return sim::PulseBand::power(values);
}

/// Across a stick in one direction. Of a table of one side, the other is its mirror image.
std::vector<Part> parts_of(const sim::BeamTable& beam,
                           const sim::BeamTable::Direction& direction,
                           int row,
                           double slope) {
  const sim::BeamRow& at = direction.rows[static_cast<std::size_t>(row)];
  const std::size_t columns = direction.values.size() / direction.rows.size();
  const auto side = static_cast<std::size_t>(beam.columns());
  const bool both_sides = columns == 2 * side;
  const auto values = std::span(direction.values).subspan(columns * row, columns);
  std::vector<Part> parts;
  const auto add = [&](double offset_m, double power) {
    const double delay_m = at.delay_m + (at.tilt + at.curvature_per_m * offset_m) * offset_m;
    parts.push_back({slope * offset_m + delay_m, power});
  };
  for (std::size_t i = 0; i < columns; ++i) {
    const double column = static_cast<double>(i) + 0.5 - (both_sides ? beam.columns() : 0);
    const double offset_m = column / at.columns_per_m, power = power_of(values[i]);
    add(offset_m, power);
    if (!both_sides) add(-offset_m, power);
  }
  return parts;
}

/// A rise at steps of kBin_m; constant beyond both ends.
struct RiseTable {
  double low_m = 0;
  std::vector<RiseValue> values;

  RiseValue at(double behind_m) const {
    const double position = (behind_m - low_m) / kBin_m;
    if (position <= 0) return {0, 0};
    if (position >= static_cast<double>(values.size() - 1)) return {1, 0};
    const auto i = static_cast<std::size_t>(position);
    const double share = position - static_cast<double>(i);
    const RiseValue &a = values[i], &b = values[i + 1];
    return {a.share + share * (b.share - a.share),
            a.slope_per_m + share * (b.slope_per_m - a.slope_per_m)};
  }
};

/// The parts' powers by place, each blurred by the pulse's.
RiseTable rise_table(const std::vector<Part>& lateral,
                     const std::vector<Part>& elevation,
                     double pulse_m) {
  const auto later = [](const Part& a, const Part& b) { return a.later_m < b.later_m; };
  const auto [low_l, high_l] = std::minmax_element(lateral.begin(), lateral.end(), later);
  const auto [low_e, high_e] = std::minmax_element(elevation.begin(), elevation.end(), later);
  const double margin_m = 8 * pulse_m, first_m = low_l->later_m + low_e->later_m;
  const double length_m = high_l->later_m + high_e->later_m - first_m;
  std::vector<double> power(static_cast<std::size_t>(length_m / kBin_m) + 2);
  double sum = 0;
  for (const Part& l : lateral) {
    for (const Part& e : elevation) {
      const double bin = (l.later_m + e.later_m - first_m) / kBin_m;
      power[static_cast<std::size_t>(bin + 0.5)] += l.power * e.power;
      sum += l.power * e.power;
    }
  }
  RiseTable table{first_m - margin_m, {}};
  const auto count = static_cast<std::size_t>((length_m + 2 * margin_m) / kBin_m) + 2;
  const EdgeRise pulse = gaussian_rise(pulse_m);
  const auto margin = static_cast<std::ptrdiff_t>(margin_m / kBin_m);
  double before = 0;  // power of the bins whose pulses have passed
  std::size_t passed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at_m = table.low_m + static_cast<double>(i) * kBin_m;
    const auto middle = static_cast<std::ptrdiff_t>(i) - margin;
    while (passed < power.size() && static_cast<std::ptrdiff_t>(passed) < middle - margin) {
      before += power[passed++];
    }
    RiseValue value{before, 0};
    for (std::size_t b = passed;
         b < power.size() && static_cast<std::ptrdiff_t>(b) <= middle + margin;
         ++b) {
      if (power[b] == 0) continue;
      const RiseValue one = pulse(at_m - (first_m + static_cast<double>(b) * kBin_m));
      value.share += power[b] * one.share;
      value.slope_per_m += power[b] * one.slope_per_m;
    }
    table.values.push_back({value.share / sum, value.slope_per_m / sum});
  }
  return table;
}

}  // namespace

EdgeRise beam_rise(const sim::BeamTable& beam,
                   double theta_rad,
                   double range_m,
                   const StickSlope& slope,
                   double pulse_fwhm_m) {
  const int row = beam.row(range_m);
  // Lateral offsets count away from the middle of the sector.
  const double side = theta_rad < 0 ? -1 : 1;
  const auto lateral =
      parts_of(beam, beam.lateral()[beam.lateral_of(theta_rad)], row, side * slope.lateral);
  const auto elevation = parts_of(beam, beam.elevation(), row, slope.elevation);
  const auto table = std::make_shared<const RiseTable>(
      rise_table(lateral, elevation, sim::power_sigma(pulse_fwhm_m)));
  return [table](double behind_m) { return table->at(behind_m); };
}

}  // namespace wobblebench::bench
