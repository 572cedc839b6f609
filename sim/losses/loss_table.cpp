#include "sim/losses/loss_table.h"

#include <algorithm>
#include <cmath>

#include "hw/probe/acquisition_plan.h"
#include "sim/losses/stick_losses.h"
#include "sim/math/fast_math.h"

namespace wobblebench::sim {

namespace {

constexpr double kStep_m = 8e-3;
constexpr int kMostSteps = 64;
/// Differences between sticks that are ignored, in nepers per step.
constexpr float kNegligible = 3e-4F;

}  // namespace

LossGrid LossGrid::of(const hw::AcquisitionPlan& plan, double depth_m) {
  const int steps = std::clamp(static_cast<int>(std::ceil(depth_m / kStep_m)), 1, kMostSteps);
  const auto& acquisition = plan.acquisition();
  return {acquisition.frames_per_volume, acquisition.sticks_per_frame, steps + 1, depth_m / steps};
}

LossTable::LossTable(const LossGrid& grid)
    : grid_(grid),
      transmitted_(plane(grid.nodes)),
      absorbed_(plane(grid.nodes)),
      material_(plane(grid.nodes)),
      bounds_(static_cast<std::size_t>(grid.frames * grid.nodes)) {}

void LossTable::record(int frame, int line, const StickTrack& track, const TissueLosses& losses) {
  double transmitted = 1, nepers = 0;
  int node = 0;
  for (std::size_t s = 0; s < track.stretches.size(); ++s) {
    const Stretch& stretch = track.stretches[s];
    if (s > 0) {
      const double through = losses.transmission(track.interfaces[s - 1]);
      transmitted *= std::sqrt(std::max(through, TissueLosses::kLeastTransmission));
    }
    const double per_m = losses.nepers_per_m(stretch.material) / 2;
    const bool is_last = s + 1 == track.stretches.size();
    for (; node < grid_.nodes && (is_last || node * grid_.step_m < stretch.to_m); ++node) {
      store(at(node, frame, line),
            transmitted,
            nepers + per_m * (node * grid_.step_m - stretch.from_m));
      material_[at(node, frame, line)] = static_cast<float>(stretch.material);
    }
    nepers += per_m * (stretch.to_m - stretch.from_m);
  }
}

void LossTable::store(std::size_t at, double transmitted, double nepers) {
  const double loss = nepers - std::log(transmitted);
  const double amplitude = std::exp(-std::min(loss, StickLosses::kMostNepers));
  transmitted_[at] = static_cast<float>(amplitude);
  absorbed_[at] = static_cast<float>(amplitude * nepers);
}

void LossTable::finish(int frame) {
  for (int node = 0; node + 1 < grid_.nodes; ++node) {
    bounds_[static_cast<std::size_t>(frame * grid_.nodes + node)] = bounds(node, frame);
  }
}

LossTable::Bounds LossTable::bounds(int node, int frame) const {
  const float* near = transmitted_.data() + at(node, frame, 0);
  const float* far = transmitted_.data() + at(node + 1, frame, 0);
  float low = 1, high = 0;
  for (int line = 0; line < grid_.lines; ++line) {
    const float ratio = far[line] / near[line];
    low = std::min(low, ratio);
    high = std::max(high, ratio);
  }
  return {low, high};
}

bool LossTable::differs(int node, int first_frame, int last_frame) const {
  Bounds all{1, 0};
  for (int frame = first_frame; frame <= last_frame; ++frame) {
    const Bounds& here = bounds_[static_cast<std::size_t>(frame * grid_.nodes + node)];
    all = {std::min(all.low, here.low), std::max(all.high, here.high)};
  }
  return all.high - all.low > kNegligible * all.high;
}

}  // namespace wobblebench::sim
