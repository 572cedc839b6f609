#include "sim/rungs/reference_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "base/parallel.h"
#include "sim/optics/element_sum.h"
#include "sim/rungs/scatterers_model.h"
#include "sim/rungs/stick_propagation.h"

namespace wobblebench::sim {

namespace {

constexpr double kAxisStep_m = 1e-3;
/// Time of one term (one source, one frequency), measured on one core of 2 GHz.
constexpr double kTerm_s = 1.5e-9;
constexpr double kFrequencies = 50;  ///< approximate number for the echo of one scatterer
constexpr double kLongest_s = 1800;  ///< on one core
constexpr int kSampledSticks = 16;   ///< used to estimate the cost of a volume

ScattererSettings reference_settings() {
  return {BeamShape::side_lobes, false};
}

/// Linear interpolation of a curve sampled at ranges (i + 1/2) * spacing_m.
double at_range(std::span<const float> curve, double spacing_m, double range_m) {
  const double position =
      std::clamp(range_m / spacing_m - 0.5, 0.0, static_cast<double>(curve.size()) - 1);
  const auto before = static_cast<std::size_t>(position);
  const std::size_t behind = std::min(before + 1, curve.size() - 1);
  const double fraction = position - static_cast<double>(before);
  return (1 - fraction) * static_cast<double>(curve[before]) +
         fraction * static_cast<double>(curve[behind]);
}

std::string minutes(double seconds) {
  std::ostringstream text;
  text.precision(2);
  text << seconds / 60 << " min";
  return text.str();
}

}  // namespace

ReferenceScene::ReferenceScene(const ScannedTissue& tissue,
                               const ProbeOptics& optics,
                               const SimulationOptions& options)
    : optics_(optics),
      scatterers_(tissue, optics, options, reference_settings()),
      points_(tissue, scatterers_.beam()),
      axis_step_m_(std::max(kAxisStep_m, optics.plan().acquisition().depth_m / 1000)) {
  check_cost();
  const double depth_m = optics.plan().acquisition().depth_m;
  const int count = static_cast<int>(std::ceil(depth_m / axis_step_m_)) + 1;
  on_axis_.resize(static_cast<std::size_t>(count));
  const ElementSum middle(optics, 0);
  parallel_ranges(count, options.threads, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      on_axis_[static_cast<std::size_t>(i)] = middle.on_axis((i + 0.5) * axis_step_m_);
    }
  });
}

void ReferenceScene::check_cost() const {
  const hw::AcquisitionPlan& plan = optics_.plan();
  const int sticks = plan.sticks_per_volume();
  const int sampled = std::min(sticks, kSampledSticks);
  double scatterers = 0, terms = 0;
  const ElementSum middle(optics_, 0);
  PointsInBeam beside = points_;
  for (int i = 0; i < sampled; ++i) {
    const hw::StickIndex index =
        plan.index(static_cast<std::uint64_t>((i + 0.5) * sticks / sampled));
    const TimedRay line = stick_ray(plan, index);
    std::vector<PointEcho> found = scatterers_.near(line, plan.acquisition().depth_m);
    const auto points = beside.find(line, plan.acquisition().depth_m);
    found.insert(found.end(), points.begin(), points.end());
    for (const PointEcho& point : found) {
      scatterers += static_cast<double>(sticks) / sampled;
      const double range_m = glm::distance(point.position_m, line.ray.origin);
      terms += static_cast<double>(sticks) / sampled * kFrequencies *
               static_cast<double>(middle.sources(range_m));
    }
  }
  if (terms * kTerm_s <= kLongest_s) return;
  std::ostringstream allowed;
  allowed.precision(2);
  allowed << scatterers << " echoes of scatterers on " << sticks << " sticks over "
          << plan.probe().elements << " elements would take about " << minutes(terms * kTerm_s)
          << " of one core; at most " << minutes(kLongest_s)
          << ": use fewer sticks, less depth or fewer scatterers_per_cell";
  throw InvalidOption("fidelity", "reference", allowed.str());
}

double ReferenceScene::on_axis(double range_m) const {
  const double position =
      std::clamp(range_m / axis_step_m_ - 0.5, 0.0, static_cast<double>(on_axis_.size()) - 1);
  const auto before = static_cast<std::size_t>(position);
  const std::size_t behind = std::min(before + 1, on_axis_.size() - 1);
  return on_axis_[before] +
         (position - static_cast<double>(before)) * (on_axis_[behind] - on_axis_[before]);
}

void ReferenceScene::add_echoes(const StickPath& path, std::span<std::complex<float>> iq) const {
  if (path.remaining.empty()) return;
  add_points(path, scatterers_.near(path.line, echo_range_m(path)), iq);
}

void ReferenceScene::add_points(const StickPath& path,
                                std::span<const PointEcho> points,
                                std::span<std::complex<float>> iq) const {
  const ElementSum sum(optics_, stick_angle_rad(path.line.ray));
  const AcrossStick across = across_stick(path.line.ray);
  std::vector<std::complex<double>> echoes(iq.size());
  for (const PointEcho& point : points) {
    const glm::dvec3 from_face = point.position_m - path.line.ray.origin;
    const glm::dvec3 position_m(glm::dot(from_face, path.line.ray.direction),
                                glm::dot(from_face, across.lateral),
                                glm::dot(from_face, across.elevation));
    const double delay_m =
        path.delay_m.empty() ? 0 : at_range(path.delay_m, path.spacing_m, position_m.x);
    const InterfaceFront* front =
        front_at(path.fronts,
                 point.interface.before,
                 point.interface.behind,
                 static_cast<int>(std::lround((position_m.x + delay_m) / path.spacing_m)));
    const double left = front != nullptr
                            ? static_cast<double>(front->remaining)
                            : at_range(path.remaining, path.spacing_m, position_m.x + delay_m);
    const double amplitude = left * static_cast<double>(point.amplitude) / on_axis(position_m.x);
    const double frequency_ratio =
        path.frequency_ratio.empty()
            ? 1
            : at_range(path.frequency_ratio, path.spacing_m, position_m.x + delay_m);
    sum.add({position_m, amplitude, frequency_ratio}, delay_m, path.spacing_m, echoes);
  }
  for (std::size_t i = 0; i < iq.size(); ++i) iq[i] += std::complex<float>(echoes[i]);
}

namespace {

using Complex = std::complex<float>;

constexpr std::string_view kReferenceEffects[] = {"element_sum"};

}  // namespace

constinit const EchoModelType ReferenceModel::kType = {
    .name = "reference",
    .lower = &ScatterersModel::kType,
    .added_effects = kReferenceEffects,
    .reach_m = &ScatterersModel::reach_m,
    .memory = [](const hw::AcquisitionPlan& plan,
                 const SimulationOptions& options,
                 bool tissue_moves) { return iq_memory(plan, options, tissue_moves, 0); },
    .make = &make_iq_model<ReferenceModel>};

ReferenceModel::ReferenceModel(const ScannedTissue& tissue,
                               const ProbeOptics& optics,
                               const SimulationOptions& options)
    : IqModel(optics.plan(), options),
      tissue_(tissue),
      propagation_(tissue_, optics, options, Surfaces::crossed),
      scene_(tissue_, optics, options) {}

IqMaker ReferenceModel::iq_maker() const {
  const auto samples = static_cast<std::size_t>(propagation_.samples());
  return [this,
          propagation = propagation_,
          points = scene_.points(),
          iq = std::vector<Complex>(samples)](const hw::StickIndex& index) mutable {
    propagation.follow(index);
    std::fill(iq.begin(), iq.end(), Complex(0));
    scene_.add_echoes(propagation.path(), iq);
    propagation.vary_tissue(iq);
    scene_.add_points(propagation.path(), points.find(propagation.path()), iq);
    propagation.add_specular_echoes(iq);
    propagation.add_clutter(iq);
    return std::span<const Complex>(iq);
  };
}

}  // namespace wobblebench::sim
