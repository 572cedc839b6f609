#include "sim/optics/beam_plane.h"

#include <algorithm>
#include <cmath>

#include "sim/optics/point_spread.h"

namespace wobblebench::sim {

namespace {

constexpr int kSearchColumns = 96;
constexpr int kSearchRows = 8;     // ranges between those at which the reach is searched
constexpr double kMainLobe = 0.8;  // of the distance to the first zero
constexpr double kLobes = 6;       // searched: the main lobe and side lobes

}  // namespace

BeamPlane::BeamPlane(const hw::AcquisitionPlan& plan,
                     const PulseBand& band,
                     const BeamReach& reach,
                     bool both_sides)
    : wavelength_m_(wavelength_m(plan)), band_(band), reach_(reach), both_sides_(both_sides) {}

BeamPlane BeamPlane::lateral(const hw::AcquisitionPlan& plan,
                             const PulseBand& band,
                             Apodisation apodisation,
                             double theta_rad,
                             const BeamReach& reach) {
  BeamPlane plane(plan, band, reach, true);
  const StickAperture aperture(plan, apodisation, theta_rad);
  plane.response_ = [&plan, band, aperture](double range_m) {
    return PlaneResponse::lateral(aperture, plan, band, range_m);
  };
  plane.aperture_m_ = [&plan](double range_m) { return receive_aperture_m(plan, range_m); };
  plane.shadow_m_ = [&plan](double range_m) {
    return transmit_aperture_m(plan, range_m) *
           std::abs(1 - range_m / transmit_focus_m(plan, range_m));
  };
  return plane;
}

BeamPlane BeamPlane::elevation(const hw::AcquisitionPlan& plan,
                               const PulseBand& band,
                               Apodisation apodisation,
                               const BeamReach& reach) {
  BeamPlane plane(plan, band, reach, false);
  const ElevationSources lens(plan);
  const StickAperture middle(plan, apodisation, 0);
  const double height_m = plan.probe().element_height_m;
  const double focus_m = plan.probe().elevation_focus_m;
  plane.response_ = [&plan, band, lens, middle](double range_m) {
    return PlaneResponse::elevation(lens, band, InPlaneExcess(middle, plan, band, range_m));
  };
  plane.aperture_m_ = [height_m](double) { return height_m; };
  plane.shadow_m_ = [=](double range_m) { return height_m * std::abs(1 - range_m / focus_m); };
  return plane;
}

double BeamPlane::reach_m(double range_m) const {
  const double widest_m = kLobes * lobe_m(range_m) + 0.5 * shadow_m_(range_m);
  const SampledRow row = sample(range_m, widest_m, kSearchColumns);
  return std::max(power_reach_m(row, band_, reach_.course.at(range_m), reach_.beyond),
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

PulseBand::Values BeamPlane::on_axis(double range_m) const {
  const PlanePoint axis{range_m, 0};
  return response_(range_m).at({&axis, 1}).front();
}

}  // namespace wobblebench::sim
