// Whether registration recovers errors of the probe that are planted on purpose.
#pragma once

#include <cstdint>
#include <vector>

#include "base/part_done.h"
#include "bench/evaluation/registration/registration.h"
#include "bench/studies/fit/fit_scans.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// What the true probe has above the one that renderer and fit assume.
struct PlantedErrors {
  double scale = 0.01;     ///< true over assumed speed of sound - 1
  double bias_m = 0.5e-3;  ///< added to the found depths
  double motor_angle_rad = 1 * kDegree;
  double wobble_radius_m = 1e-3;

  /// By place in Registration::value; 0 for the pose.
  double of(int parameter) const;
};

/// Those of the defaults that the scene's probe can have: the sign turns where a range ends.
PlantedErrors plantable(const Scene& scene);

struct PlantedParameter {
  int parameter = 0;  ///< place in Registration::value
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
  double repeatable_rms_m = 0;         ///< of distances: what is the same in every reference seed
  double random_rms_m = 0;             ///< and what is not
};

inline constexpr int kReferenceSeeds = 10;

/// For each seed, sticks of a probe with all planted errors at once are rendered and registered as
/// if they were the scene's, its pose known. A detector's own error repeats from seed to seed and
/// looks like ray bias and range scale: the mean distance of each pixel over kReferenceSeeds other
/// seeds without planted errors is subtracted, so that the intervals are of what is left: speckle,
/// and what the planted errors change of the detector's.
Coverage measure_coverage(const Scene& scene,
                          const LoadedPhantom& phantom,
                          int seeds,
                          render::GlContext& context,
                          const PartDone& done);

}  // namespace wobblebench::bench
