#include "bench/studies/rungs/rung_comparison.h"

#include <algorithm>
#include <ctime>
#include <memory>
#include <optional>

#include "sim/losses/aperture_losses.h"
#include "sim/optics/pulse_band.h"
#include "sim/probe_simulator.h"
#include "sim/receive/receiver.h"
#include "sim/rungs/echo_model.h"
#include "sim/rungs/field_model.h"
#include "sim/rungs/scatterers_model.h"
#include "sim/rungs/stick_propagation.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::bench {

namespace {

double cpu_ms() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Adds the CPU time of a call to `sum_ms`.
template <class Body>
void timed(double& sum_ms, const Body& body) {
  const double begin = cpu_ms();
  body();
  sum_ms += cpu_ms() - begin;
}

sim::ScannedTissue subject_of(const RungScene& scene, sim::Rung rung) {
  return {std::make_shared<const sim::TissueMap>(scene.subject.phantom,
                                                 sim::echo_model_type(rung).reach_m(scene.plan),
                                                 scene.options.threads),
          scene.subject.phantom.materials(),
          scene.subject.placement,
          slow_path()};
}

StageTimes geometry_stages(const RungScene& scene) {
  const auto subject = subject_of(scene, sim::Rung::geometry);
  double follow_ms = 0, all_ms = 0;
  sim::StickTrack track;
  for (int stick = 0; stick < scene.plan.sticks_per_volume(); ++stick) {
    const auto line =
        sim::stick_ray(scene.plan, scene.plan.index(static_cast<std::uint64_t>(stick)));
    timed(follow_ms, [&] {
      sim::follow(subject, line, scene.plan.acquisition().depth_m, track, sim::Surfaces::crossed);
    });
  }
  auto options = scene.options;
  options.fidelity = sim::Rung::geometry;
  options.threads = 1;
  const sim::ProbeSimulator simulator(
      {scene.subject.phantom, scene.subject.placement, slow_path()}, scene.plan, options);
  timed(all_ms, [&] { simulator.volume(0); });
  return {sim::Rung::geometry,
          {{"follow", follow_ms}, {"rest", std::max(0.0, all_ms - follow_ms)}},
          0,
          0};
}

std::unique_ptr<const sim::IqModel> make_model(const sim::ProbeOptics& optics,
                                               const sim::ScannedTissue& subject,
                                               const sim::SimulationOptions& options) {
  if (options.fidelity == sim::Rung::scatterers) {
    return std::make_unique<sim::ScatterersModel>(subject, optics, options);
  }
  return std::make_unique<sim::FieldModel>(subject, optics, options);
}

/// The stages of a model, and their memory.
struct Worker {
  double spacing_m;
  int samples;
  sim::Surfaces surfaces;
  sim::StickTrack track;
  sim::StickLosses losses;
  std::optional<sim::ApertureLosses> aperture;
  std::shared_ptr<const sim::VolumeCorrections> corrections;
  sim::MeanPower power;
  std::vector<float> mean_power;

  Worker(const sim::ProbeOptics& optics,
         const sim::ScannedTissue& subject,
         const sim::SimulationOptions& options)
      : spacing_m(optics.iq_spacing_m()),
        samples(optics.iq_samples()),
        surfaces(options.fidelity == sim::Rung::field ? sim::Surfaces::nearby
                                                      : sim::Surfaces::crossed),
        losses(optics.plan(), options, subject.materials, spacing_m, samples),
        power(optics, options, subject.materials, spacing_m, samples, subject.map->reach_m()),
        mean_power(static_cast<std::size_t>(samples)) {
    if (!sim::has_aperture_losses(options, subject.materials)) return;
    aperture.emplace(subject, optics, options, optics.plan().acquisition().depth_m);
  }

  /// What the sticks of a volume share.
  void prepare() {
    if (aperture) corrections = aperture->volume(0);
  }
  void compute_losses(const hw::StickIndex& index) {
    losses.compute(track, corrections ? corrections->of(index) : sim::ApertureCorrection());
  }
};

/// Fills the caches of the tissue (sim/speckle/scatterers/tissue_blocks.h), so that this is not
/// timed.
void warm_up(const RungScene& scene,
             const sim::ScannedTissue& subject,
             const sim::IqMaker& make,
             const sim::ScattererField& scatterers,
             Worker& worker) {
  std::vector<std::complex<float>> iq(static_cast<std::size_t>(worker.samples));
  for (int stick = 0; stick < scene.plan.sticks_per_volume(); ++stick) {
    const auto index = sim::stick_in_order(scene.plan, 0, stick);
    const auto line = sim::stick_ray(scene.plan, index);
    sim::follow(subject, line, scene.plan.acquisition().depth_m, worker.track, worker.surfaces);
    worker.compute_losses(index);
    scatterers.add_echoes(sim::visible_path(line, worker.spacing_m, worker.losses), iq);
    make(index);
  }
}

}  // namespace

double StageTimes::total_ms() const {
  double sum = 0;
  for (const auto& [name, ms] : stages) sum += ms;
  return sum;
}

StageTimes measure_stages(const RungScene& scene, sim::Rung rung) {
  if (rung == sim::Rung::geometry) return geometry_stages(scene);
  auto options = scene.options;
  options.fidelity = rung;
  options.threads = 1;
  const auto subject = subject_of(scene, rung);
  StageTimes result;
  result.rung = rung;
  std::unique_ptr<const sim::IqModel> model;
  timed(result.once_ms,
        [&] { model = make_model(sim::ProbeOptics(scene.plan, options), subject, options); });
  const sim::ProbeOptics optics(scene.plan, options);
  std::optional<sim::ScattererField> scatterers;
  if (rung == sim::Rung::scatterers) {
    const auto course = sim::highest_frequency(subject, optics, options);
    scatterers.emplace(subject, optics, options, sim::ScattererSettings::of(options, course));
  }

  Worker worker(optics, subject, options);
  const sim::IqMaker make = model->iq_maker();
  sim::Receiver receiver(scene.plan, options, sim::iq_oversampling(scene.plan));
  std::vector<std::complex<float>> spare(static_cast<std::size_t>(worker.samples));
  std::span<const std::complex<float>> iq;
  std::vector<float> samples(static_cast<std::size_t>(scene.plan.acquisition().samples_per_stick));
  double shared_ms = 0, follow_ms = 0, losses_ms = 0, tissue_ms = 0, all_ms = 0, receive_ms = 0;
  timed(shared_ms, [&] { worker.prepare(); });
  model->prepare(0);
  if (scatterers) warm_up(scene, subject, make, *scatterers, worker);
  for (int stick = 0; stick < scene.plan.sticks_per_volume(); ++stick) {
    const auto index = sim::stick_in_order(scene.plan, 0, stick);
    const auto line = sim::stick_ray(scene.plan, index);
    timed(follow_ms, [&] {
      sim::follow(subject, line, scene.plan.acquisition().depth_m, worker.track, worker.surfaces);
    });
    timed(losses_ms, [&] { worker.compute_losses(index); });
    timed(tissue_ms, [&] {
      if (scatterers) {
        scatterers->add_echoes(
            sim::visible_path(line, worker.spacing_m, worker.losses), spare, &result.scatterers);
      } else {
        worker.power.compute(
            worker.track, worker.losses, sim::stick_angle_rad(line.ray), worker.mean_power);
      }
    });
    timed(all_ms, [&] { iq = make(index); });
    timed(receive_ms, [&] { receiver.detect(iq, static_cast<std::uint64_t>(stick), samples); });
  }
  const double rest_ms = std::max(0.0, all_ms - follow_ms - losses_ms - tissue_ms);
  result.stages = {{"follow", follow_ms},
                   {"losses", shared_ms + losses_ms},
                   {scatterers ? "scatterers" : "mean power", tissue_ms},
                   {"speckle, specular", rest_ms},
                   {"receive", receive_ms}};
  return result;
}

}  // namespace wobblebench::bench
