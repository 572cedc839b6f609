#include "bench/evaluation/truth/shadows.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "sim/receive/receiver.h"
#include "sim/rungs/echo_model.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/tissue/scanned_tissue.h"

namespace wobblebench::bench {

double brightest_target_db(const phantoms::Phantom& phantom) {
  const auto level_db = [&](phantoms::MaterialIndex index) {
    return phantom.materials().at(static_cast<std::size_t>(index)).backscatter_db;
  };
  double brightest_db = level_db(phantom.background());
  for (const phantoms::Surface& surface : phantom.surfaces()) {
    if (surface.is_target) brightest_db = std::max(brightest_db, level_db(surface.inside));
  }
  return brightest_db;
}

namespace {

/// Amplitude at the face below which an echo from a range drowns.
double floor_amplitude(const hw::AcquisitionPlan& plan,
                       const sim::SimulationOptions& options,
                       double range_m) {
  const double noise =
      options.noise_db > sim::kZeroAmplitude_db ? sim::amplitude_of_db(options.noise_db) : 0;
  if (options.output == hw::SampleScale::linear_envelope) return noise;
  const double darkest = sim::amplitude_of_db(options.full_scale_db - options.dynamic_range_db);
  return std::max(noise, darkest / sim::time_gain(plan, options, range_m));
}

double reach_of(const sim::StickPropagation& stick,
                const hw::AcquisitionPlan& plan,
                const sim::SimulationOptions& options,
                double tissue) {
  const auto& remaining = stick.losses().remaining();
  const auto& delay_m = stick.losses().delay_m();
  for (std::size_t k = remaining.size(); k-- > 0;) {
    const double apparent_m = (static_cast<double>(k) + 0.5) * stick.spacing_m();
    if (tissue * static_cast<double>(remaining[k]) < floor_amplitude(plan, options, apparent_m)) {
      continue;
    }
    const bool is_last = k + 1 == static_cast<std::size_t>(stick.samples());
    if (is_last) return std::numeric_limits<double>::infinity();
    return apparent_m - (delay_m.empty() ? 0.0 : static_cast<double>(delay_m[k]));
  }
  return 0;
}

}  // namespace

StickReach::StickReach(const phantoms::PlacedPhantom& subject,
                       const hw::AcquisitionPlan& plan,
                       const sim::SimulationOptions& options,
                       const sim::TissueMapSource& maps,
                       std::uint32_t volume)
    : plan_(plan),
      geometry_(plan.geometry()),
      volume_(volume),
      reach_m_(static_cast<std::size_t>(plan.sticks_per_volume()),
               std::numeric_limits<double>::infinity()) {
  const auto fidelity = sim::choose_fidelity(
      options, plan, !subject.motion.still(), !subject.phantom.scatterers().empty());
  if (fidelity.rung == sim::Rung::geometry) return;
  trace(subject, options, maps, sim::echo_model_type(fidelity.rung).reach_m(plan));
}

void StickReach::trace(const phantoms::PlacedPhantom& subject,
                       const sim::SimulationOptions& options,
                       const sim::TissueMapSource& maps,
                       double reach_m) {
  const sim::ScannedTissue tissue{
      maps ? maps(subject.phantom, reach_m, options.threads)
           : std::make_shared<const sim::TissueMap>(subject.phantom, reach_m, options.threads),
      subject.phantom.materials(),
      subject.placement,
      subject.motion};
  sim::SimulationOptions losses_alone = options;
  losses_alone.clutter = {};
  const sim::StickPropagation shared(
      tissue, sim::ProbeOptics(plan_, options), losses_alone, sim::Surfaces::crossed);
  shared.prepare(volume_);
  const double brightest = sim::amplitude_of_db(brightest_target_db(subject.phantom));
  const auto lines = static_cast<std::uint32_t>(plan_.acquisition().sticks_per_frame);
  parallel_ranges(plan_.sticks_per_volume(), options.threads, [&](int first, int last) {
    sim::StickPropagation stick(shared);
    for (int i = first; i < last; ++i) {
      const auto index = static_cast<std::uint32_t>(i);
      stick.follow({volume_, index / lines, index % lines});
      reach_m_[index] = reach_of(stick, plan_, options, brightest);
    }
  });
}

double StickReach::at(const glm::dvec3& position_m) const {
  const hw::StickIndex stick = plan_.nearest_stick(geometry_.to_polar(position_m), volume_);
  const auto lines = static_cast<std::size_t>(plan_.acquisition().sticks_per_frame);
  return reach_m_[stick.frame * lines + stick.line];
}

void mark_shadowed(Truth& truth, const StickReach& reach, const render::Camera& camera) {
  parallel_rows(truth.kind.height, [&](int row) {
    for (int column = 0; column < truth.kind.width; ++column) {
      TruthKind& kind = truth.kind.at(column, row);
      if (kind != TruthKind::surface) continue;
      const auto depth_m = static_cast<double>(truth.depth_m.at(column, row));
      const double reach_m = reach.at(camera.ray(column, row).at(depth_m));
      if (static_cast<double>(truth.range_m.at(column, row)) <= reach_m) continue;
      kind = TruthKind::shadowed;
      truth.depth_m.at(column, row) = kNoSurface;
    }
  });
}

void mark_outside(Truth& truth,
                  const hw::MotorDeviation& motor,
                  const hw::ProbeGeometry& geometry,
                  const render::Camera& camera) {
  for (int row = 0; row < truth.kind.height; ++row) {
    for (int column = 0; column < truth.kind.width; ++column) {
      TruthKind& kind = truth.kind.at(column, row);
      if (kind == TruthKind::none) continue;
      const auto crossing_m = static_cast<double>(truth.crossing_m.at(column, row));
      const double phi_rad = geometry.to_polar(camera.ray(column, row).at(crossing_m)).phi_rad;
      if (phi_rad >= motor.low_rad && phi_rad <= motor.high_rad) continue;
      kind = TruthKind::outside_field;
      truth.depth_m.at(column, row) = kNoSurface;
    }
  }
}

Truth true_surface(const ResolvedScene& scene,
                   const sim::TissueMapSource& maps,
                   std::uint32_t volume) {
  return true_surface(scene, scene.view(), StickReach(scene, maps, volume), volume);
}

Truth true_surface(const ResolvedScene& scene,
                   const render::View& view,
                   const StickReach& reach,
                   std::uint32_t volume) {
  Truth truth = trace_truth(scene.subject().value(), scene.plan(), view, volume);
  truth.cut_by_box_percent =
      cut_by_box_percent(scene.subject().value(), scene.plan(), view, volume);
  mark_shadowed(truth, reach, view.camera);
  return truth;
}

}  // namespace wobblebench::bench
