// Speed and accuracy of the rungs of the simulator: the measurements of the command `rungs`.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/image.h"
#include "bench/output/progress.h"
#include "bench/scene/scene.h"
#include "bench/studies/rungs/rung_error.h"
#include "bench/studies/rungs/rung_stages.h"
#include "bench/studies/rungs/rung_time.h"
#include "bench/studies/validate/statistics.h"

namespace wobblebench::bench {

/// Runs `body` in a fork of this process and returns the peak resident size of that, in bytes
/// (getrusage). Must be called before this process works on other threads, which a fork does not
/// have. (Threads that libraries start idle when loaded, as OpenVDB's logging does, are not
/// needed.) Throws UserError for what the user gave (bench/scene/late_refusal.h), and
/// std::runtime_error for every other failure of the body.
double peak_memory_bytes(const std::function<void()>& body);

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

/// One frame, scan-converted in its plane: grey values as displayed, white outside the sector.
Image<float> frame_picture(const hw::AcquisitionPlan& plan,
                           const std::vector<float>& volume,
                           int frame,
                           int width);

/// Steps of measure_rungs(), with their usual shares of its time.
std::vector<PlannedStep> rungs_steps(int repeats);

/// Measures all of the above. Nothing may have worked on other threads before, because memory is
/// measured in forks of this process.
RungsResults measure_rungs(const Scene& scene, int repeats, Progress& progress);

}  // namespace wobblebench::bench
