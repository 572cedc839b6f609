#include "tests/bench/evaluation/bound/plane_oracle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "base/parallel.h"
#include "base/statistics.h"
#include "base/units.h"
#include "bench/evaluation/bound/detection_bound.h"
#include "phantoms/phantom.h"
#include "phantoms/placed_phantom.h"
#include "sim/optics/beam_table.h"
#include "sim/optics/probe_optics.h"
#include "sim/optics/pulse_band.h"
#include "sim/probe_simulator.h"
#include "sim/speckle/iq_field.h"
#include "sim/tissue/tissue_map.h"
#include "tests/bench/evaluation/bound/beam_pair.h"
#include "tests/bench/evaluation/bound/oracle.h"

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

/// The plane in front of the probe, and its closed form.
struct TiltedPlane {
  phantoms::PlacedPhantom subject;
  glm::dvec3 point;
  glm::dvec3 normal;  ///< out of the tissue

  TiltedPlane(const PlaneCell& cell, double face_m);
  double range_m(const hw::Ray& stick) const;
};

/// One stick: what the oracle knows of it.
struct PlaneStick {
  hw::StickIndex index;
  double edge_m = 0;
  DetectionConditions conditions;
  EdgeSignal signal;
  double first_m = 0;
  int first_sample = 0;
  int samples = 0;
  double bound_m = 0;  ///< of `signal`
};

/// The sticks of a cell.
class PlaneScan {
 public:
  explicit PlaneScan(const PlaneCell& cell);

  const std::vector<PlaneStick>& sticks() const { return sticks_; }
  const hw::AcquisitionPlan& plan() const { return plan_; }

  /// `scatterers`: moved as it is; its beam hardly varies within an error of the oracle.
  EdgeSignal signal_at(const PlaneStick& stick, double edge_m) const;

  /// [stick][seed], the samples of each stick's window.
  std::vector<std::vector<IqSamples>> samples() const;

 private:
  PlaneStick stick(const hw::StickIndex& index) const;
  /// The rung `field` takes the beam's width at each sample.
  EdgePair field_pair(const hw::PolarPoint& point, const DetectionConditions& at_edge) const;
  void place_window(PlaneStick& stick) const;

  PlaneCell cell_;
  hw::AcquisitionPlan plan_;
  sim::SimulationOptions options_;
  TiltedPlane plane_;
  sim::BeamProfile profile_;
  std::optional<sim::BeamTable> beam_;
  std::vector<PlaneStick> sticks_;
};

TiltedPlane::TiltedPlane(const PlaneCell& cell, double face_m)
    : subject(phantoms::still_at(
          phantoms::make_phantom({.name = "plane",
                                  .tilt_x_rad = cell.across ? cell.incidence_rad : 0,
                                  .tilt_y_rad = cell.across ? 0 : cell.incidence_rad}),
          {0, 0, face_m + cell.range_m})),
      point(subject.placement.position_m) {
  const double sine = std::sin(cell.incidence_rad), cosine = std::cos(cell.incidence_rad);
  normal = cell.across ? glm::dvec3(0, sine, -cosine) : glm::dvec3(-sine, 0, -cosine);
}

double TiltedPlane::range_m(const hw::Ray& stick) const {
  return glm::dot(point - stick.origin, normal) / glm::dot(stick.direction, normal);
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
    const hw::PolarPoint point{edge_m, plan_.theta_rad(static_cast<int>(stick.index.line)), 0};
    signal.pair = field_pair(point, stick.conditions);
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
  hw::PolarPoint point = angles;
  point.range_m = result.edge_m;
  result.conditions = conditions_at(plan_,
                                    profile_,
                                    options_,
                                    point,
                                    plane_.normal,
                                    phantoms::material("soft_tissue").backscatter_db);
  result.signal = edge_signal(result.conditions);
  result.signal.pair = beam_ ? beam_pair(*beam_,
                                         sim::PulseBand(plan_),
                                         point,
                                         stick_slope(point, geometry, plane_.normal),
                                         result.conditions.sample_spacing_m)
                             : field_pair(point, result.conditions);
  place_window(result);
  const auto covariance =
      edge_covariance(result.signal, result.edge_m, result.first_m, result.samples);
  result.bound_m = 1 / std::sqrt(covariance_information(covariance.value, covariance.derivative));
  return result;
}

EdgePair PlaneScan::field_pair(const hw::PolarPoint& point,
                               const DetectionConditions& at_edge) const {
  const EdgeRise rise = [this, point, at_edge](double behind_m) {
    const double range_m = std::clamp(point.range_m + behind_m, 0.0, plan_.acquisition().depth_m);
    DetectionConditions there = at_edge;
    there.lateral_fwhm_m = profile_.lateral_fwhm_m(range_m, point.theta_rad);
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

/// Half a bound a step, as far as the rise is wide and no less than 12 bounds.
SearchGrid search_about(const PlaneStick& stick) {
  const double step_m = 0.5 * stick.bound_m;
  const double reach_m = std::max(12 * stick.bound_m, 2 * rise_sigma_m(stick.conditions));
  const int side = static_cast<int>(std::ceil(reach_m / step_m));
  return {stick.edge_m - side * step_m, step_m, 2 * side + 1};
}

std::vector<std::vector<double>> oracle_errors(const PlaneScan& scan) {
  const auto samples = scan.samples();
  std::vector<std::vector<double>> errors(samples.size());
  parallel_rows(static_cast<int>(samples.size()), [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    const PlaneStick& stick = scan.sticks()[at];
    errors[at] = most_likely_edges_m([&](double edge_m) { return scan.signal_at(stick, edge_m); },
                                     stick.first_m,
                                     samples[at],
                                     search_about(stick));
    for (double& error : errors[at]) error -= stick.edge_m;
  });
  return errors;
}

/// Mean squares of a lone stick's bounds.
void add_bounds(const PlaneScan& scan, PlaneBound& result) {
  std::vector<double> bounds, rung_bounds, envelopes;
  for (const PlaneStick& stick : scan.sticks()) {
    bounds.push_back(detection_bound_m(stick.conditions));
    rung_bounds.push_back(stick.bound_m);
    envelopes.push_back(envelope_bound_m(stick.conditions, scan.plan().sample_spacing_m()));
  }
  result.bound_m = root_mean_square(bounds);
  result.rung_bound_m = root_mean_square(rung_bounds);
  result.envelope_m = root_mean_square(envelopes);
}

/// The interval is that of the mean of independent squares.
void add_ratio(const std::vector<double>& errors, PlaneBound& result) {
  const auto n = static_cast<double>(errors.size());
  const double rms_m = root_mean_square(errors), mean2 = rms_m * rms_m;
  double spread = 0;
  for (const double error : errors) spread += (error * error - mean2) * (error * error - mean2);
  const double half = 1.96 * std::sqrt(spread / (n - 1) / n) / mean2;
  result.n = static_cast<int>(errors.size());
  result.oracle_rms_m = rms_m;
  result.oracle_bias_m = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  result.ratio = rms_m / result.bound_m;
  result.ratio_low = result.ratio * std::sqrt(std::max(0.0, 1 - half));
  result.ratio_high = result.ratio * std::sqrt(1 + half);
  result.rung_ratio = rms_m / result.rung_bound_m;
}

}  // namespace

PlaneBound measure_plane_bound(const PlaneCell& cell) {
  if (cell.rung != sim::Rung::field && cell.rung != sim::Rung::scatterers) {
    throw std::invalid_argument("measure_plane_bound: rung: must be field or scatterers");
  }
  if (!(std::abs(cell.incidence_rad) <= 60 * kDegree + 1e-9)) {
    throw std::invalid_argument("measure_plane_bound: incidence_rad: must be at most 60 degrees");
  }
  const PlaneScan scan(cell);
  std::vector<double> errors;
  for (const auto& of_stick : oracle_errors(scan)) {
    errors.insert(errors.end(), of_stick.begin(), of_stick.end());
  }
  PlaneBound result;
  add_bounds(scan, result);
  add_ratio(errors, result);
  return result;
}

}  // namespace wobblebench::bench
