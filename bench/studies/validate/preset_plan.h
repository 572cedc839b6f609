// Plans of the presets' scans, with a few lines beyond both ends of the sector.
#pragma once

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/probe.h"

namespace wobblebench::bench {

/// A preset's sector with `beyond` more lines on either side at the same spacing, so that sticks
/// can turn past a place on the last one. The array ends where it does.
/// `acquisition.sticks_per_frame` counts the lines of the sector itself; its sector is ignored.
inline hw::AcquisitionPlan preset_plan(hw::ProbePreset preset,
                                       hw::AcquisitionOptions acquisition,
                                       int beyond) {
  const hw::ProbePresetData& data = hw::probe_preset(preset);
  const int steps = acquisition.sticks_per_frame - 1;
  acquisition.sector_rad = data.sector_rad * (steps + 2 * beyond) / steps;
  acquisition.sticks_per_frame += 2 * beyond;
  return {data.probe, acquisition};
}

}  // namespace wobblebench::bench
