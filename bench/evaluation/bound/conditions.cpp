// The conditions at a place of the simulator's field.
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "bench/evaluation/bound/detection_bound.h"
#include "sim/optics/pulse_band.h"

namespace wobblebench::bench {

namespace {

/// Between a stick and the neighbour that it does not have.
constexpr double kAlone_m = 1;

}  // namespace

StickSlope stick_slope(const hw::PolarPoint& place,
                       const hw::ProbeGeometry& geometry,
                       const glm::dvec3& normal) {
  const glm::dvec3 axis = geometry.stick(place.theta_rad, place.phi_rad).direction;
  // Across the image plane, which turns about an axis parallel to x.
  const glm::dvec3 elevation(0, -std::cos(place.phi_rad), -std::sin(place.phi_rad));
  const glm::dvec3 lateral = glm::cross(axis, elevation);
  const double along = std::abs(glm::dot(normal, axis));
  const double across = std::hypot(glm::dot(normal, lateral), glm::dot(normal, elevation));
  const double most = across > 0 ? std::tan(kMostIncidence_rad) / across : 0;
  const double scale = std::min(1 / std::max(along, 1e-12), most);
  return {scale * glm::dot(normal, lateral), scale * glm::dot(normal, elevation)};
}

double speckle_power_db(double mean_echo_db) {
  // A Rayleigh envelope's mean squared is pi / 4 of its mean square.
  return mean_echo_db + 10 * std::log10(4 / kPi);
}

DetectionConditions conditions_at(const hw::AcquisitionPlan& plan,
                                  const sim::BeamProfile& profile,
                                  const sim::SimulationOptions& options,
                                  const hw::PolarPoint& place,
                                  const glm::dvec3& normal,
                                  double tissue_mean_db) {
  const hw::ProbeGeometry geometry = plan.geometry();
  const StickSlope slope = stick_slope(place, geometry, normal);
  const double level = profile.level(place.range_m, place.theta_rad);
  const double radius_m = geometry.radius_m() + place.range_m;
  const double from_axis_m = radius_m * std::cos(place.theta_rad) - geometry.axis_z_m();
  const auto spacing_m = [](double arc_m) { return arc_m > 0 ? arc_m : kAlone_m; };
  return {.incidence_rad = std::atan(std::hypot(slope.lateral, slope.elevation)),
          .azimuth_rad = std::atan2(slope.elevation, slope.lateral),
          .tissue_db = speckle_power_db(tissue_mean_db) + 20 * std::log10(level),
          .noise_db = options.noise_db,
          .lateral_fwhm_m = profile.lateral_fwhm_m(place.range_m, place.theta_rad),
          .elevation_fwhm_m = profile.elevation_fwhm_m(place.range_m),
          .pulse_fwhm_m = sim::axial_fwhm_m(plan),
          .sample_spacing_m = plan.sample_spacing_m() / sim::iq_oversampling(plan),
          .line_spacing_m = spacing_m(radius_m * plan.theta_step_rad()),
          .frame_spacing_m = spacing_m(from_axis_m * plan.phi_step_rad())};
}

}  // namespace wobblebench::bench
