#include "sim/receive.h"

#include <algorithm>
#include <cmath>

#include "sim/losses.h"
#include "sim/random.h"

namespace wobblebench::sim {

float log_compressed(double amplitude, const SimulationOptions& options) {
  if (!(amplitude > 0)) return 0;
  const double db = 20 * std::log10(amplitude) - options.full_scale_db;
  return static_cast<float>(std::clamp(1 + db / options.dynamic_range_db, 0.0, 1.0));
}

void receive(std::span<const std::complex<float>> iq,
             std::uint64_t noise_key,
             const hw::AcquisitionPlan& plan,
             const SimulationOptions& options,
             std::span<float> samples) {
  const std::size_t per_output = iq.size() / samples.size();
  // Without the low-pass, the middle IQ sample stands for the output sample.
  const std::size_t first = options.low_pass ? 0 : per_output / 2;
  const std::size_t count = options.low_pass ? per_output : 1;
  const bool noisy = options.noise_db > kSilent_db;
  const float noise = static_cast<float>(amplitude_of_db(options.noise_db));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    float envelope = 0;
    for (std::size_t i = k * per_output + first; i < k * per_output + first + count; ++i) {
      envelope += std::abs(noisy ? iq[i] + noise * complex_normal(noise_key, i) : iq[i]);
    }
    const double gained = envelope / static_cast<float>(count) *
                          time_gain(plan, options, plan.sample_range_m(static_cast<int>(k)));
    samples[k] = options.output == hw::SampleScale::linear_envelope
                     ? static_cast<float>(gained / amplitude_of_db(options.full_scale_db))
                     : log_compressed(gained, options);
  }
}

}  // namespace wobblebench::sim
