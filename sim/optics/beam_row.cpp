#include "sim/optics/beam_row.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/matrix.hpp>
#include <glm/vec3.hpp>

#include "base/units.h"

namespace wobblebench::sim {

namespace {

/// Group delays of a row, continuous from the middle of the beam outwards: a phase determines them
/// only up to a period.
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

constexpr int kSearchColumns = 96;
constexpr int kSearchRows = 8;     ///< steps between the ranges at which the reach is searched
constexpr double kMainLobe = 0.8;  ///< of the distance to the first zero
constexpr double kLobes = 6;       ///< searched: the main lobe and side lobes

constexpr int kSpeckleColumns = 48;  ///< a side

/// Half width of a row for speckle: three lobes, and the geometric shadow of the transmit aperture.
double speckle_reach_m(double lobe_m, double transmit_m, double range_m, double focus_m) {
  return 3 * lobe_m + 0.6 * transmit_m * std::abs(1 - range_m / focus_m);
}

double elevation_row_reach_m(const ProbeOptics& optics, double range_m) {
  const double height_m = optics.probe().element_height_m;
  return speckle_reach_m(optics.wavelength_m() * range_m / height_m,
                         height_m,
                         range_m,
                         optics.probe().elevation_focus_m);
}

}  // namespace

double SampledRow::power_m(std::size_t node) const {
  double sum = 0;
  for (const auto& value : values) sum += std::norm(value[node]);
  return (both_sides ? 1 : 2) * step_m() * sum;
}

std::array<double, PulseBand::kNodes> SampledRow::node_powers() const {
  std::array<double, PulseBand::kNodes> powers = {};
  for (const auto& value : values) {
    for (std::size_t node = 0; node < powers.size(); ++node) powers[node] += std::norm(value[node]);
  }
  return powers;
}

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
    // A symmetric beam has no tilt.
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

ElevationRow::ElevationRow(const ProbeOptics& optics, double range_m)
    : response(PlaneResponse::elevation(optics, range_m)),
      row(sample_row(
          response, range_m, elevation_row_reach_m(optics, range_m), true, kSpeckleColumns)) {}

SampledRow lateral_row(const StickAperture& aperture, double range_m) {
  return sample_row(PlaneResponse::lateral(aperture, range_m),
                    range_m,
                    lateral_row_reach_m(aperture.optics(), range_m),
                    true,
                    kSpeckleColumns);
}

double lateral_row_reach_m(const ProbeOptics& optics, double range_m) {
  return speckle_reach_m(optics.wavelength_m() * range_m / optics.receive_aperture_m(range_m),
                         optics.transmit_aperture_m(range_m),
                         range_m,
                         optics.transmit_focus_m(range_m));
}

BeamPlane::BeamPlane(const ProbeOptics& optics, const BeamReach& reach, bool both_sides)
    : optics_(optics), reach_(reach), both_sides_(both_sides) {}

BeamPlane BeamPlane::lateral(const ProbeOptics& optics, double theta_rad, const BeamReach& reach) {
  BeamPlane plane(optics, reach, true);
  plane.response_ = [aperture = StickAperture(optics, theta_rad)](double range_m) {
    return PlaneResponse::lateral(aperture, range_m);
  };
  plane.aperture_m_ = [optics](double range_m) { return optics.receive_aperture_m(range_m); };
  plane.shadow_m_ = [optics](double range_m) {
    return optics.transmit_aperture_m(range_m) *
           std::abs(1 - range_m / optics.transmit_focus_m(range_m));
  };
  return plane;
}

BeamPlane BeamPlane::elevation(const ProbeOptics& optics, const BeamReach& reach) {
  BeamPlane plane(optics, reach, false);
  const double height_m = optics.probe().element_height_m;
  const double focus_m = optics.probe().elevation_focus_m;
  plane.response_ = [optics](double range_m) { return PlaneResponse::elevation(optics, range_m); };
  plane.aperture_m_ = [height_m](double) { return height_m; };
  plane.shadow_m_ = [=](double range_m) { return height_m * std::abs(1 - range_m / focus_m); };
  return plane;
}

double BeamPlane::reach_m(double range_m) const {
  const double widest_m = kLobes * lobe_m(range_m) + 0.5 * shadow_m_(range_m);
  const SampledRow row = sample(range_m, widest_m, kSearchColumns);
  return std::max(power_reach_m(row, optics_.band(), reach_.course.at(range_m), reach_.beyond),
                  kMainLobe * lobe_m(range_m));
}

std::vector<double> BeamPlane::reaches_m(double first_m, double step_m, int count) const {
  std::vector<double> searched;
  for (int i = 0; i < count + kSearchRows; i += kSearchRows) {
    searched.push_back(reach_m(first_m + i * step_m));
  }
  std::vector<double> reaches;
  for (int i = 0; i < count; ++i) {
    const auto before = static_cast<std::size_t>(i / kSearchRows);
    const double share = static_cast<double>(i % kSearchRows) / kSearchRows;
    reaches.push_back((1 - share) * searched[before] + share * searched[before + 1]);
  }
  return reaches;
}

}  // namespace wobblebench::sim
