#include "sim/echo/mean_frequency.h"

#include <cstdint>

#include "sim/echo/stick_propagation.h"

namespace wobblebench::sim {

namespace {

constexpr std::uint64_t kSticks = 97;  // a prime: not all on the same lines

}  // namespace

FrequencyCourse mean_frequency(const ScannedTissue& tissue,
                               const hw::AcquisitionPlan& plan,
                               const SimulationOptions& options) {
  SimulationOptions axis_alone = options;
  axis_alone.aperture_losses = false;
  StickPropagation propagation(tissue, plan, axis_alone, Surfaces::crossed);
  const auto samples = static_cast<std::size_t>(propagation.samples());
  std::vector<double> sum(samples);
  std::vector<int> count(samples);
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  for (std::uint64_t i = 0; i < kSticks; ++i) {
    propagation.follow(plan.index(sticks * i / kSticks));
    const std::span<const float> ratio = propagation.path().frequency_ratio;
    for (std::size_t at = 0; at < ratio.size(); ++at) {
      sum[at] += static_cast<double>(ratio[at]);
      ++count[at];
    }
  }
  FrequencyCourse course{propagation.spacing_m(), {}};
  for (std::size_t at = 0; at < samples && count[at] > 0; ++at) {
    course.ratio.push_back(static_cast<float>(sum[at] / count[at]));
  }
  return course;
}

}  // namespace wobblebench::sim
