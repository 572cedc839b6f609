// Speed and accuracy of the simulator's rungs: the measurements of the command `rungs`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/image.h"
#include "bench/studies/rungs/rung_error.h"
#include "bench/studies/rungs/rung_growth.h"
#include "bench/studies/rungs/rung_stages.h"
#include "bench/studies/rungs/rung_time.h"
#include "bench/studies/validate/seeds.h"

namespace wobblebench::bench {

/// The rungs that scan whole volumes, in rising order.
const std::vector<sim::Rung>& volume_rungs();

/// Peak resident size of a process that builds the phantom and then scans it.
struct MemoryPeak {
  std::string what;
  double bytes = 0;
};

/// The same frame on each rung.
struct RungFrame {
  std::string rung;
  Image<float> picture;  ///< grey values in [0, 1]
};

struct RungsResults {
  std::string phantom;
  double sound_ms = 0;  ///< acquisition time of a volume
  double samples = 0;   ///< per volume
  int repeats = 0;
  std::vector<std::uint64_t> seeds;
  std::vector<MemoryPeak> memory;
  std::vector<RungTime> times;
  std::vector<StageTimes> stages;
  std::vector<GrowthPoint> growth;
  std::vector<RungError> errors;
  VolumeTime small_scatterers;  ///< of small_sheet()
  VolumeTime small_reference;
  std::vector<RungFrame> frames;  ///< the middle one of the phantom
};

/// A sheet of tissue across the axis under a few sticks: small enough for `reference`.
RungScene small_sheet(const sim::SimulationOptions& options);
/// Repeats after one warm-up; `reference` takes two seconds for a volume.
inline constexpr int kSmallRepeats = 3;

/// Estimated lower bound of the time of a volume on two AVX2 cores (docs/architecture.md): 10 ms
/// for the 1.21 million samples of `field`, 0.2 s for 47 million scatterers. 0: no estimate.
double floor_ms(sim::Rung rung, const RungsResults& results);

/// One frame, scan-converted in its plane: grey values as displayed, white outside the sector.
Image<float> frame_picture(const hw::AcquisitionPlan& plan,
                           const std::vector<float>& volume,
                           int frame,
                           int width);

}  // namespace wobblebench::bench
