#include "bench/studies/latency/line_rate.h"

#include <cmath>

namespace wobblebench::bench {

namespace {

constexpr int kSeeds = 9;
constexpr int kVolumes = 300;
constexpr int kHalvings = 12;
/// Ends of the depths that an acquisition can have (AcquisitionOptions).
constexpr double kShallowest_m = 1e-3, kDeepest_m = 0.4;

bool loses(VirtualSetting setting, StreamPolicy policy, double depth_m, std::uint64_t seed) {
  hw::AcquisitionOptions acquisition = setting.plan.acquisition();
  acquisition.depth_m = depth_m;
  setting.plan = hw::AcquisitionPlan(setting.plan.probe(), acquisition);
  setting.queue.policy = policy;
  setting.volumes = kVolumes;
  setting.seed = seed;
  const VirtualResult result = run_virtual_stream(setting);
  return policy == StreamPolicy::every ? result.sticks_lost > 0 : result.superseded_volumes > 0;
}

/// The shallowest depth, by bisection of its logarithm, at which nothing is lost; the deepest if
/// something always is.
double first_loss_m(const VirtualSetting& setting, StreamPolicy policy, std::uint64_t seed) {
  double shallow = std::log(kShallowest_m), deep = std::log(kDeepest_m);
  if (!loses(setting, policy, kShallowest_m, seed)) return kShallowest_m;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (shallow + deep);
    (loses(setting, policy, std::exp(middle), seed) ? shallow : deep) = middle;
  }
  return std::exp(deep);
}

LineRate first_loss(const VirtualSetting& setting, StreamPolicy policy, const std::string& loss) {
  std::vector<double> rates;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    hw::AcquisitionOptions acquisition = setting.plan.acquisition();
    acquisition.depth_m = first_loss_m(setting, policy, seed);
    rates.push_back(1 / hw::AcquisitionPlan(setting.plan.probe(), acquisition).stick_period_s());
  }
  return {loss, spread_of(rates)};
}

}  // namespace

std::vector<LineRate> first_losses(const VirtualSetting& setting) {
  return {first_loss(setting, StreamPolicy::newest, "a volume, policy newest"),
          first_loss(setting, StreamPolicy::every, "a stick, policy every")};
}

}  // namespace wobblebench::bench
