#include "bench/studies/validate/scan.h"

#include <algorithm>
#include <cmath>

namespace wobblebench::bench {

std::vector<double> Scan::stick(int frame, int line) const {
  std::vector<double> values;
  for (int k = 0; k < plan.acquisition().samples_per_stick; ++k) {
    values.push_back(at(frame, line, k));
  }
  return values;
}

int Scan::sample_at(double range_m) const {
  const double index = std::ceil(range_m / plan.sample_spacing_m() - 0.5 - 1e-9);
  return std::clamp(static_cast<int>(index), 0, plan.acquisition().samples_per_stick);
}

sim::SimulationOptions bare_envelope(sim::Rung rung, std::uint64_t seed) {
  sim::SimulationOptions options;
  options.fidelity = rung;
  options.seed = seed;
  options.tgc_db_per_cm_mhz = 0;
  options.noise_db = sim::kSilent_db;
  options.full_scale_db = 0;
  options.low_pass = false;
  options.output = hw::SampleScale::linear_envelope;
  return options;
}

sim::SimulationOptions lossless_envelope(sim::Rung rung, std::uint64_t seed) {
  auto options = bare_envelope(rung, seed);
  options.attenuation = false;
  options.transmission_loss = false;
  options.interface_echo = false;
  return options;
}

phantoms::Placement placed_at(const glm::dvec3& position_m) {
  return {glm::dmat3(1.0), position_m};
}

Scan scan(const phantoms::Phantom& phantom,
          const phantoms::Placement& placement,
          const hw::AcquisitionPlan& plan,
          const sim::SimulationOptions& options,
          const phantoms::Motion& motion,
          std::uint32_t volume) {
  const sim::ProbeSimulator simulator(phantom, placement, plan, options, motion);
  return {plan, simulator.volume(volume)};
}

}  // namespace wobblebench::bench
