// Whether registration recovers errors of the probe that are planted on purpose.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/part_done.h"
#include "bench/evaluation/registration/registration.h"
#include "bench/studies/fit/fit_scans.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

struct PlantedParameter {
  RegistrationParameter parameter = kScale;
  double planted = 0;
  double mean = 0;        ///< recovered, over the seeds
  double deviation = 0;   ///< standard, over the seeds
  double half_width = 0;  ///< mean, of the 95 % intervals
  int covered = 0;        ///< seeds whose interval holds the planted error
  int held_nothing = 0;   ///< reference seeds whose interval holds 0
};

struct PlantedSeed {
  std::uint64_t seed = 0;
  Registration fit;  ///< of what differs from the reference
};

struct Coverage {
  std::vector<PlantedParameter> parameters;
  std::vector<PlantedSeed> seeds;
  std::vector<PlantedSeed> reference;  ///< nothing planted; each differs from the others' mean
  double repeatable_rms_m = 0;         ///< of distances: the part that is equal in every reference
  double random_rms_m = 0;             ///< and the part that is not
};

inline constexpr int kReferenceSeeds = 10;

/// For each seed, sticks of a probe with all planted errors at once are rendered and registered as
/// if they were the scene's, with the pose known. A detector's own error repeats from seed to seed
/// and looks like ray bias and range scale: the mean distance of each pixel over kReferenceSeeds
/// other seeds without planted errors is subtracted, so that the intervals are of what is left:
/// speckle, and what the planted errors change of the detector's.
Coverage measure_coverage(const Scene& scene,
                          const LoadedPhantom& phantom,
                          int seeds,
                          render::GlContext& context,
                          const PartDone& done);

}  // namespace wobblebench::bench
