#include "bench/studies/validate/point_echoes.h"

#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "bench/studies/validate/scan.h"
#include "sim/optics/pulse_band.h"
#include "sim/rungs/reference_model.h"
#include "sim/speckle/scatterers/scatterer_field.h"

namespace wobblebench::bench {

PointEchoes::PointEchoes(sim::Rung rung,
                         const hw::AcquisitionPlan& plan,
                         bool side_lobes,
                         WayLoss loss)
    : plan_(plan), loss_(std::move(loss)) {
  if (sim::iq_oversampling(plan) != 1) throw std::invalid_argument("PointEchoes: coarse samples");
  auto options = lossless_envelope(rung, 1);
  options.side_lobes = side_lobes;
  const auto water = open_tissue("amniotic_fluid");
  const sim::ScannedTissue subject{
      std::make_shared<const sim::TissueMap>(water, 1e-3, options.threads),
      water.materials(),
      {},
      {}};
  if (rung == sim::Rung::reference) {
    const auto scene = std::make_shared<const sim::ReferenceScene>(
        subject, sim::ProbeOptics(plan, options), options);
    add_ = [=](const auto& path, auto points, auto iq) { scene->add_points(path, points, iq); };
  } else {
    const auto settings =
        sim::ScattererSettings::of(options, {plan.sample_spacing_m(), loss_.frequency_ratio});
    const auto field = std::make_shared<const sim::ScattererField>(
        subject, sim::ProbeOptics(plan, options), options, settings);
    add_ = [=](const auto& path, auto points, auto iq) { field->add_points(path, points, iq); };
  }
}

std::vector<double> PointEchoes::envelope(double theta_rad,
                                          double phi_rad,
                                          std::span<const sim::PointEcho> points) const {
  const auto samples = static_cast<std::size_t>(plan_.acquisition().samples_per_stick);
  const std::vector<float> left =
      loss_.remaining.empty() ? std::vector<float>(samples, 1.0f) : loss_.remaining;
  std::vector<std::complex<float>> iq(samples);
  const sim::TimedRay line{plan_.geometry().stick(theta_rad, phi_rad), 0};
  add_({line, plan_.sample_spacing_m(), left, {}, loss_.frequency_ratio}, points, iq);
  std::vector<double> envelope;
  for (const auto& value : iq) envelope.push_back(static_cast<double>(std::abs(value)));
  return envelope;
}

}  // namespace wobblebench::bench
