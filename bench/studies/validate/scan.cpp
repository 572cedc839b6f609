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
  options.noise_db = sim::kZeroAmplitude_db;
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

Scan scan(const phantoms::PlacedPhantom& subject,
          const hw::AcquisitionPlan& plan,
          const sim::SimulationOptions& options,
          std::uint32_t volume) {
  return {plan, sim::ProbeSimulator(subject, plan, options).volume(volume)};
}

}  // namespace wobblebench::bench
