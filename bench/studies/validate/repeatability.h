// Repeatability: equal seeds give equal bytes, whatever the number of threads.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/studies/validate/common/study_report.h"
#include "hw/probe/acquisition_plan.h"
#include "sim/options.h"

namespace wobblebench::bench {

struct RepeatabilityInputs {
  std::vector<sim::Rung> rungs = {
      sim::Rung::geometry, sim::Rung::field, sim::Rung::scatterers, sim::Rung::reference};
  std::string phantom = "fetal_face";
  double voxel_m = 1e-3;
  hw::AcquisitionOptions acquisition = {.frames_per_volume = 6};
  std::vector<int> threads = {1, 2, 4};
  std::uint64_t seed = 1;
};

struct RepeatabilityResult {
  sim::Rung rung = sim::Rung::field;
  bool moving = false;
  long differing = 0;  ///< samples that differ from those of the first run, over all further runs
  long samples = 0;    ///< of one run
  int runs = 0;
  double other_seed = 0;     ///< fraction of the samples that another seed changes
  std::uint32_t crc32c = 0;  ///< of the samples
};

/// Each rung, still and moving, in this order. `reference` scans a small body with a few sticks,
/// the others the phantom.
std::vector<RepeatabilityResult> measure_repeatability(const RepeatabilityInputs& inputs);

StudyReport repeatability_report();

}  // namespace wobblebench::bench
