#include "sim/optics/beam_row.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "base/units.h"

namespace wobblebench::sim {

namespace {

/// Group delays of a row, continuous from the middle of the beam outwards: a phase alone gives them
/// up to a period.
std::vector<double> group_delays_m(const SampledRow& row, const PulseBand& band) {
  const int before = band.below_center();
  const auto low = static_cast<std::size_t>(before), high = low + 1;
  const double spacing = band.offset_per_m(before + 1) - band.offset_per_m(before);
  const double period_m = kPi / spacing;
  std::vector<double> delays;
  for (const auto& value : row.values) {
    delays.push_back(-std::arg(value[high] * std::conj(value[low])) / (2 * spacing));
  }
  const auto unwrap = [&](std::size_t at, std::size_t neighbour) {
    delays[at] -= period_m * std::round((delays[at] - delays[neighbour]) / period_m);
  };
  const std::size_t middle = row.both_sides ? delays.size() / 2 : 0;
  for (std::size_t i = middle + 1; i < delays.size(); ++i) unwrap(i, i - 1);
  for (std::size_t i = middle; i-- > 0;) unwrap(i, i + 1);
  return delays;
}

}  // namespace

SampledRow sample_row(
    const PlaneResponse& response, double range_m, double reach_m, bool both_sides, int columns) {
  SampledRow row{reach_m, both_sides, {}};
  row.values.resize(static_cast<std::size_t>(both_sides ? 2 * columns : columns));
  std::vector<PlanePoint> points;
  for (std::size_t i = 0; i < row.values.size(); ++i) points.push_back({range_m, row.offset_m(i)});
  row.values = response.at(points);
  return row;
}

double power_reach_m(const SampledRow& row,
                     const PulseBand& band,
                     double frequency_ratio,
                     double beyond) {
  const std::size_t count = row.values.size(), side = row.both_sides ? count / 2 : count;
  std::vector<double> power(side);  // by distance from the axis
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t away = !row.both_sides ? i : i >= side ? i - side : side - 1 - i;
    power[away] += band.power(row.values[i], frequency_ratio);
  }
  double outside = beyond * std::accumulate(power.begin(), power.end(), 0.0);
  std::size_t last = side - 1;
  while (last > 0 && power[last] <= outside) outside -= power[last--];
  const double share = power[last] > 0 ? outside / power[last] : 0;
  return row.reach_m * (static_cast<double>(last) + 1 - share) / static_cast<double>(side);
}

RowDelay fit_delay(const SampledRow& row, const PulseBand& band) {
  const std::vector<double> delays = group_delays_m(row, band);
  glm::dmat3 normal(0.0);
  glm::dvec3 right(0.0);
  for (std::size_t i = 0; i < row.values.size(); ++i) {
    const double u = row.offset_m(i) / row.reach_m;
    const double weight = band.power(row.values[i]);
    // A beam that is even has no tilt.
    const glm::dvec3 basis(1, row.both_sides ? u : 0, u * u);
    normal += weight * glm::outerProduct(basis, basis);
    right += weight * delays[i] * basis;
  }
  if (!row.both_sides) normal[1][1] = 1;
  if (!(std::abs(glm::determinant(normal)) > 0)) return {};
  const glm::dvec3 fit = glm::inverse(normal) * right;
  return {fit[0], fit[1] / row.reach_m, fit[2] / (row.reach_m * row.reach_m)};
}

std::vector<PulseBand::Values> aligned(const SampledRow& row,
                                       const RowDelay& delay,
                                       const PulseBand& band,
                                       double scale) {
  std::vector<PulseBand::Values> values = row.values;
  for (std::size_t c = 0; c < values.size(); ++c) {
    const double delay_m = delay.at(row.offset_m(c));
    for (int node = 0; node < band.nodes(); ++node) {
      values[c][static_cast<std::size_t>(node)] *=
          std::polar(scale, 2 * band.wavenumber_per_m(node) * delay_m);
    }
  }
  return values;
}

}  // namespace wobblebench::sim
