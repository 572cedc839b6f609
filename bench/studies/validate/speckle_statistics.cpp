#include "bench/studies/validate/speckle_statistics.h"

#include <algorithm>
#include <cmath>

#include "bench/studies/validate/bodies.h"
#include "bench/studies/validate/scan.h"
#include "sim/receive/losses.h"

namespace wobblebench::bench {

namespace {

constexpr char kTissue[] = "soft_tissue";

}  // namespace

double rayleigh_snr() {
  return std::sqrt(kPi / (4 - kPi));
}

int SpeckleResult::rejected() const {
  return static_cast<int>(std::count_if(seeds.begin(), seeds.end(), [](const Seed& seed) {
    return seed.distance > rayleigh_critical_distance(static_cast<double>(seed.n));
  }));
}

SpeckleResult measure_speckle(sim::Rung rung, const SpeckleInputs& inputs) {
  const hw::AcquisitionPlan plan({}, inputs.acquisition);
  const auto tissue = open_tissue(kTissue);
  const double mean = sim::amplitude_of_db(phantoms::material(kTissue).backscatter_db);
  const int step =
      std::max(1, static_cast<int>(std::ceil(inputs.step_m / plan.sample_spacing_m())));
  SpeckleResult result;
  for (const std::uint64_t seed : inputs.seeds) {
    auto options = lossless_envelope(rung, seed);
    options.scatterers_per_cell = inputs.scatterers_per_cell;
    const Scan volume = scan({tissue}, plan, options);
    std::vector<double> envelope;
    for (int frame = 0; frame < inputs.acquisition.frames_per_volume; ++frame) {
      for (int line = 0; line < inputs.acquisition.sticks_per_frame; ++line) {
        const int last = volume.sample_at(inputs.to_m);
        for (int k = volume.sample_at(inputs.from_m); k < last; k += step) {
          envelope.push_back(volume.at(frame, line, k) / mean);
        }
      }
    }
    for (const double value : envelope) {
      result.envelope.add(value);
      result.intensity.add(value * value);
    }
    result.values.insert(result.values.end(), envelope.begin(), envelope.end());
    const long n = static_cast<long>(envelope.size());
    result.seeds.push_back({rayleigh_distance(std::move(envelope)), n});
  }
  return result;
}

}  // namespace wobblebench::bench
