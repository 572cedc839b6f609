#include "bench/evaluation/bound/plane_scan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>

#include "base/units.h"
#include "bench/evaluation/bound/beam_pair.h"
#include "phantoms/phantom.h"
#include "sim/optics/pulse_band.h"
#include "sim/probe_simulator.h"
#include "sim/speckle/iq_field.h"
#include "sim/tissue/tissue_map.h"

namespace wobblebench::bench {

namespace {

hw::AcquisitionPlan few_sticks() {
  constexpr int kLines = 3, kFrames = 5;
  constexpr double kStep_rad = 3 * kDegree;
  return {{},
          {.sector_rad = (kLines - 1) * kStep_rad,
           .fan_rad = (kFrames - 1) * kStep_rad,
           .sticks_per_frame = kLines,
           .frames_per_volume = kFrames}};
}

sim::SimulationOptions options_of(const PlaneCell& cell) {
  sim::SimulationOptions options;
  options.fidelity = cell.rung;
  options.attenuation = false;
  options.transmission_loss = false;
  options.aperture_losses = false;
  options.interface_echo = false;
  options.noise_db = cell.noise_db;
  options.scatterers_per_cell = cell.scatterers_per_cell;
  return options;
}

/// Speckle of `field`: white noise through the taps of the pulse.
SpeckleCorrelation tap_correlation(double pulse_sigma_m, double spacing_m) {
  const std::vector<float> taps =
      sim::unit_power_gaussian(pulse_sigma_m / spacing_m, sim::kMaxHalfPulse);
  return [taps, spacing_m](double distance_m) {
    const auto lag = static_cast<std::size_t>(std::lround(std::abs(distance_m) / spacing_m));
    double sum = 0;
    for (std::size_t i = 0; i + lag < taps.size(); ++i) {
      sum += static_cast<double>(taps[i]) * static_cast<double>(taps[i + lag]);
    }
    return sum;
  };
}

}  // namespace

TiltedPlane::TiltedPlane(const PlaneCell& cell, double face_m)
    : subject(phantoms::still_at(
          phantoms::make_phantom({.name = "plane",
                                  .tilt_x_rad = cell.across ? cell.incidence_rad : 0,
                                  .tilt_y_rad = cell.across ? 0 : cell.incidence_rad}),
          {0, 0, face_m + cell.range_m})),
      place(subject.placement.position_m) {
  const double sine = std::sin(cell.incidence_rad), cosine = std::cos(cell.incidence_rad);
  normal = cell.across ? glm::dvec3(0, sine, -cosine) : glm::dvec3(-sine, 0, -cosine);
}

double TiltedPlane::range_m(const hw::Ray& stick) const {
  return glm::dot(place - stick.origin, normal) / glm::dot(stick.direction, normal);
}
PlaneScan::PlaneScan(const PlaneCell& cell)
    : cell_(cell),
      plan_(few_sticks()),
      options_(options_of(cell)),
      plane_(cell, plan_.probe().radius_m),
      profile_(sim::ProbeOptics(plan_, options_)) {
  if (cell.rung == sim::Rung::scatterers) {
    beam_.emplace(sim::ProbeOptics(plan_, options_), sim::BeamShape::main_lobe);
  }
  for (int i = 0; i < plan_.sticks_per_volume(); ++i) {
    sticks_.push_back(stick(plan_.index(static_cast<std::uint64_t>(i))));
  }
}

EdgeSignal PlaneScan::signal_at(const PlaneStick& stick, double edge_m) const {
  EdgeSignal signal = stick.signal;
  if (!beam_) {
    const hw::PolarPoint place{edge_m, plan_.theta_rad(static_cast<int>(stick.index.line)), 0};
    signal.pair = field_pair(place, stick.conditions);
  }
  return signal;
}
std::vector<std::vector<IqSamples>> PlaneScan::samples() const {
  std::vector<std::vector<IqSamples>> result(sticks_.size());
  for (auto& of_seeds : result) of_seeds.resize(cell_.seeds.size());
  sim::SimulationOptions options = options_;
  std::shared_ptr<const sim::TissueMap> map;
  const sim::TissueMapSource maps = [&](const phantoms::Phantom& phantom, double reach_m, int n) {
    if (!map) map = std::make_shared<const sim::TissueMap>(phantom, reach_m, n);
    return map;
  };
  for (std::size_t seed = 0; seed < cell_.seeds.size(); ++seed) {
    options.seed = cell_.seeds[seed];
    const sim::ProbeSimulator simulator(plane_.subject, plan_, options, maps);
    simulator.volume(0, [&](const hw::StickIndex& index, auto iq) {
      const auto at = static_cast<std::size_t>(plan_.sequence(index));
      const PlaneStick& of = sticks_[at];
      const auto window = iq.subspan(static_cast<std::size_t>(of.first_sample),
                                     static_cast<std::size_t>(of.samples));
      result[at][seed].assign(window.begin(), window.end());
    });
  }
  return result;
}

PlaneStick PlaneScan::stick(const hw::StickIndex& index) const {
  PlaneStick result{.index = index};
  const hw::PolarPoint angles{
      0, plan_.theta_rad(static_cast<int>(index.line)), plan_.motor_angle_rad(index)};
  const hw::ProbeGeometry geometry = plan_.geometry();
  result.edge_m = plane_.range_m(geometry.stick(angles.theta_rad, angles.phi_rad));
  hw::PolarPoint place = angles;
  place.range_m = result.edge_m;
  result.conditions = conditions_at(plan_,
                                    profile_,
                                    options_,
                                    place,
                                    plane_.normal,
                                    phantoms::material("soft_tissue").backscatter_db);
  result.signal = edge_signal(result.conditions);
  result.signal.pair = beam_ ? beam_pair(*beam_,
                                         sim::PulseBand(plan_),
                                         place,
                                         stick_slope(place, geometry, plane_.normal),
                                         result.conditions.sample_spacing_m)
                             : field_pair(place, result.conditions);
  place_window(result);
  const auto covariance =
      edge_covariance(result.signal, result.edge_m, result.first_m, result.samples);
  result.bound_m = 1 / std::sqrt(covariance_information(covariance.value, covariance.derivative));
  return result;
}

EdgePair PlaneScan::field_pair(const hw::PolarPoint& place,
                               const DetectionConditions& at_edge) const {
  const EdgeRise rise = [this, place, at_edge](double behind_m) {
    const double range_m = std::clamp(place.range_m + behind_m, 0.0, plan_.acquisition().depth_m);
    DetectionConditions there = at_edge;
    there.lateral_fwhm_m = profile_.lateral_fwhm_m(range_m, place.theta_rad);
    there.elevation_fwhm_m = profile_.elevation_fwhm_m(range_m);
    return gaussian_rise(rise_sigma_m(there))(behind_m);
  };
  return edge_after_pulse(
      tap_correlation(sim::sigma_of_fwhm(at_edge.pulse_fwhm_m), at_edge.sample_spacing_m), rise);
}

void PlaneScan::place_window(PlaneStick& stick) const {
  const SampleWindow window = sample_window(stick.conditions);
  const double spacing_m = stick.conditions.sample_spacing_m;
  const int all = plan_.acquisition().samples_per_stick * sim::iq_oversampling(plan_);
  const int first = static_cast<int>((stick.edge_m + window.first_m) / spacing_m);
  stick.first_sample = std::clamp(first, 0, all - 1);
  stick.samples = std::min(window.count, all - stick.first_sample);
  stick.first_m = (stick.first_sample + 0.5) * spacing_m;
}

}  // namespace wobblebench::bench
