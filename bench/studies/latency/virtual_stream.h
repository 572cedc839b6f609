// A stream in virtual time: what a schedule, a card and service times make of it, without waiting.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/statistics.h"
#include "bench/pipeline/stream/stream_queues.h"
#include "bench/studies/latency/service_times.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// The link sends nothing from `at_s` on, for `for_s`; then all that it held back.
struct Stall {
  double at_s = 0;
  double for_s = 0;
};

struct VirtualSetting {
  hw::AcquisitionPlan plan;
  sim::CardOptions card;
  ServiceTimes times;
  QueueOptions queue;
  int volumes = 100;
  std::optional<Stall> stall;
  int ring_slots = 4096;  ///< of the board
  std::uint64_t seed = 1;
};

/// Seconds on the device's clock.
struct VirtualPicture {
  std::uint32_t volume = 0;
  double first_fired_s = 0, last_fired_s = 0;
  double announced_s = 0;  ///< the card's interrupt for the last stick
  double acquired_s = 0;
  double ready_s = 0;

  double age_newest_s() const { return ready_s - last_fired_s; }
};

struct VirtualResult {
  std::vector<VirtualPicture> pictures;
  std::uint64_t superseded_volumes = 0;   ///< before rendering
  std::uint64_t superseded_pictures = 0;  ///< before writing
  std::uint64_t sticks_lost = 0;          ///< the board's ring was full
};

/// Reader, queue, renderer and sink as bench/pipeline/stream has them, with service times drawn
/// from the pools. Whole volumes only; no volume ends early. With StreamPolicy::every a card that
/// does not wait loses sticks once the ring is full of those that the reader cannot take.
VirtualResult run_virtual_stream(const VirtualSetting& setting);

/// Sticks a second at which loss begins, over draws of service times.
struct LineRate {
  std::string loss;  ///< of what, with which policy
  Spread per_s;
};

/// Line rates at the first loss: with `every` the first stick that finds the board's ring full,
/// with `newest` the first volume that is superseded; lines and frames are the setting's, the depth
/// makes the rate.
std::vector<LineRate> first_losses(const VirtualSetting& setting);

}  // namespace wobblebench::bench
