// What the modelled card does with the sticks of a volume, and when.
#pragma once

#include <vector>

#include "bench/pipeline/stream/stream_summary.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// Of one stick, on the device's clock, seconds after the volume's first stick was fired.
struct CardTimes {
  double dma_complete_s = 0;  ///< the last byte of its packet has come over the PCIe link
  double interrupt_s = 0;     ///< that announces this byte
};

/// Of all sticks of a volume, in the order of acquisition, as sim::SimLink sends them through a
/// card (sim/card/card_model.h) whose buffers are read at each interrupt.
std::vector<CardTimes> card_times(const hw::AcquisitionPlan& plan, const sim::CardOptions& card);

CardDelays card_delays(const hw::AcquisitionPlan& plan, const sim::CardOptions& card);

}  // namespace wobblebench::bench
