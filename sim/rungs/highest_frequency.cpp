#include "sim/rungs/highest_frequency.h"

#include <algorithm>
#include <cstdint>

#include "sim/rungs/stick_propagation.h"

namespace wobblebench::sim {

namespace {

constexpr std::uint64_t kSticks = 97;  // a prime: not all on the same lines

}  // namespace

FrequencyCourse highest_frequency(const ScannedTissue& tissue,
                                  const hw::AcquisitionPlan& plan,
                                  const SimulationOptions& options) {
  SimulationOptions axis_alone = options;
  axis_alone.aperture_losses = false;
  StickPropagation propagation(tissue, plan, axis_alone, Surfaces::crossed);
  FrequencyCourse course{propagation.spacing_m(), {}};
  const auto sticks = static_cast<std::uint64_t>(plan.sticks_per_volume());
  for (std::uint64_t i = 0; i < kSticks; ++i) {
    propagation.follow(plan.index(sticks * i / kSticks));
    const std::span<const float> ratio = propagation.path().frequency_ratio;
    if (course.ratio.size() < ratio.size()) course.ratio.resize(ratio.size(), 0.0f);
    for (std::size_t at = 0; at < ratio.size(); ++at) {
      course.ratio[at] = std::max(course.ratio[at], ratio[at]);
    }
  }
  return course;
}

}  // namespace wobblebench::sim
