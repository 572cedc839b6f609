// The order in which the sticks of a volume are computed. Results do not depend on it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "hw/probe/acquisition_plan.h"

namespace wobblebench::sim {

/// Frames whose sticks are computed together.
inline constexpr int kFramesTogether = 16;

/// Number `i` of a volume: a few frames at a time, line by line. The sticks of a line share the
/// beam's tables of their angle, and neighbouring frames the tissue: both stay in the cache.
inline hw::StickIndex stick_in_order(const hw::AcquisitionPlan& plan, std::uint32_t volume, int i) {
  const int lines = plan.acquisition().sticks_per_frame;
  const int first = i / (kFramesTogether * lines) * kFramesTogether;
  const int frames = std::min(kFramesTogether, plan.acquisition().frames_per_volume - first);
  const int within = i - first * lines;
  return {volume,
          static_cast<std::uint32_t>(first + within % frames),
          static_cast<std::uint32_t>(within / frames)};
}

}  // namespace wobblebench::sim
