#include "bench/studies/validate/rung_agreement.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/statistics.h"
#include "bench/studies/validate/point_echoes.h"
#include "bench/studies/validate/statistics.h"
#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

namespace {

constexpr double kDepth_m = 0.16;
constexpr int kSamples = 4096;  // IQ samples then need no oversampling

/// Points of a stick in the probe frame, with the amplitudes that the rungs take.
std::vector<sim::PointEcho> points_of(const EchoPlace& place, const hw::Ray& stick) {
  // The image plane is y = 0: lateral is in it, across the stick.
  const glm::dvec3 lateral(stick.direction.z, 0, -stick.direction.x), elevation(0, 1, 0);
  const double here_db = axis_level_db(hw::ProbePreset::standard, place.range_m);
  std::vector<sim::PointEcho> points;
  for (const EchoPlace::Point& point : place.points) {
    const double db = axis_level_db(hw::ProbePreset::standard, point.axial_m) - here_db;
    points.push_back(
        {stick.at(point.axial_m) + point.lateral_m * lateral + point.elevation_m * elevation,
         static_cast<float>(point.amplitude * std::pow(10, db / 20))});
  }
  return points;
}

/// Linear between samples at (k + 1/2) * spacing_m.
double at_range(const std::vector<double>& envelope, double spacing_m, double range_m) {
  const double at = range_m / spacing_m - 0.5;
  const auto before = static_cast<std::size_t>(at);
  const double share = at - static_cast<double>(before);
  return (1 - share) * envelope.at(before) + share * envelope.at(before + 1);
}

}  // namespace

std::vector<EchoAgreement> measure_agreement(const PointRung& rung,
                                             std::span<const EchoPlace> places) {
  const hw::AcquisitionPlan plan(
      {}, {.depth_m = kDepth_m, .samples_per_stick = kSamples, .frames_per_volume = 1});
  const double edge_rad = 0.5 * plan.acquisition().sector_rad;
  const PointEchoes echoes(rung.rung, plan, rung.side_lobes);
  std::vector<EchoAgreement> results(places.size());
  parallel_rows(static_cast<int>(places.size()), [&](int i) {
    const EchoPlace& place = places[static_cast<std::size_t>(i)];
    const double theta_rad = place.sector_fraction * edge_rad;
    const auto points = points_of(place, plan.geometry().stick(theta_rad, 0));
    const auto stick = echoes.envelope(theta_rad, 0, points);
    std::vector<double> found;
    for (const double range_m : place.ranges_m) {
      found.push_back(at_range(stick, plan.sample_spacing_m(), range_m));
    }
    results[static_cast<std::size_t>(i)] = {
        place.sector_fraction,
        place.range_m,
        correlation(found, place.envelope),
        20 * std::log10(root_mean_square(found) / root_mean_square(place.envelope)),
        static_cast<long>(found.size())};
  });
  return results;
}

}  // namespace wobblebench::bench
