// Speed and accuracy of the rungs of the simulator: the measurements of the command `rungs`. Times
// are measured, never asserted.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image.h"
#include "base/part_done.h"
#include "base/statistics.h"
#include "bench/output/progress.h"
#include "bench/scene/scene.h"
#include "hw/probe/acquisition_plan.h"
#include "phantoms/placed_phantom.h"
#include "sim/options.h"

namespace wobblebench::bench {

/// A scan that all rungs are compared on.
struct RungScene {
  phantoms::PlacedPhantom subject;  ///< still
  hw::AcquisitionPlan plan;
  sim::SimulationOptions options;  ///< the rung is overridden
};

/// A block of tissue in fluid; `half_m`: half its size, about the phantom's origin.
phantoms::Phantom block(const glm::dvec3& half_m, double voxel_m);

/// A slow translation, so that no echoes can be reused in the next volume.
phantoms::Motion slow_path();
/// The same with a turning joint, where the phantom has one: its tissue deforms.
phantoms::Motion bending(const phantoms::Phantom& phantom);

/// Moving volumes are timed in series of this many and averaged, as in a continuous scan.
inline constexpr int kVolumesInARow = 3;

/// Wall times with all threads that the options allow.
struct RungTime {
  sim::Rung rung = sim::Rung::field;
  Spread map_ms;      ///< once per phantom
  Spread once_ms;     ///< once per probe and seed, still phantom: tables, speckle, all echoes
  Spread still_ms;    ///< each further volume of a still phantom: its noise and receive chain
  Spread first_ms;    ///< once_ms and one volume: a still volume of a new seed
  Spread moving_ms;   ///< a volume with slow_path()
  Spread bending_ms;  ///< a volume with bending()
};

/// All rungs in turn in each repeat, after one warm-up repeat, so that a drift of the machine's
/// speed affects all equally.
std::vector<RungTime> measure_times(const RungScene& scene,
                                    const std::vector<sim::Rung>& rungs,
                                    int repeats,
                                    const PartDone& done = {});

/// A still volume of a new seed and one with slow_path(), on one rung.
struct VolumeTime {
  Spread first_ms;
  Spread moving_ms;
};
VolumeTime measure_volume(const RungScene& scene, sim::Rung rung, int repeats);

/// Sizes are varied one at a time from one base scan.
struct GrowthInputs {
  hw::AcquisitionOptions acquisition = {.sticks_per_frame = 32, .frames_per_volume = 12};
  std::vector<int> sticks = {16, 32, 64, 128};
  std::vector<int> frames = {6, 12, 24, 48};
  std::vector<int> samples = {256, 512, 1024, 2048};
  std::vector<double> scatterers = {5, 10, 20, 40};
  /// Range of the tissue's front, mm; beyond the depth: fluid alone.
  std::vector<double> front_mm = {400, 130, 100, 70, 35, -50};
  double base_front_mm = 70;
  int repeats = 9;  ///< of each point, after one warm-up
};

struct GrowthPoint {
  std::string what;  ///< "sticks", "frames", "samples", "scatterers", "tissue"
  double size = 0;   ///< their number; of tissue: its fraction of the samples
  sim::Rung rung = sim::Rung::field;
  VolumeTime time;
};

std::vector<GrowthPoint> measure_growth(const std::vector<sim::Rung>& rungs,
                                        const sim::SimulationOptions& options,
                                        const GrowthInputs& inputs,
                                        const PartDone& done = {});

/// Exponent of median time over size among the points of one kind and rung: least squares of their
/// logarithms.
double growth_exponent(const std::vector<GrowthPoint>& points,
                       const std::string& what,
                       sim::Rung rung,
                       Spread VolumeTime::*time);

/// Detected ranges of a surface along sticks less the expected ones; NaN where there are none.
struct RangeError {
  double median_mm = std::numeric_limits<double>::quiet_NaN();      ///< signed
  double median_abs_mm = std::numeric_limits<double>::quiet_NaN();  ///< of absolute differences
  double p95_abs_mm = std::numeric_limits<double>::quiet_NaN();
  long n = 0;
  /// Of the sticks that meet the surface.
  double missed_percent = std::numeric_limits<double>::quiet_NaN();
};

struct RungError {
  std::string body;
  sim::Rung rung = sim::Rung::field;
  RangeError against_truth;
  /// Against the next higher rung; none for the highest.
  std::optional<RangeError> against_above;
  std::optional<double> image_rms_db;
  std::optional<double> image_correlation;
};

/// The phantom's first target surface along each stick, from the front of its box of interest.
std::vector<double> true_ranges(const RungScene& scene);

/// `rungs` in rising order. A surface is detected where the mean of three samples first exceeds 0.3
/// of full scale, in the volume of the first seed. Images are means of the displayed values over
/// the seeds, compared where either is above zero.
std::vector<RungError> measure_rung_errors(const std::string& body,
                                           const RungScene& scene,
                                           const std::vector<sim::Rung>& rungs,
                                           const std::vector<std::uint64_t>& seeds);

/// Runs `body` in a fork of this process and returns the peak resident size of that, in bytes
/// (getrusage). Must be called before this process works on other threads, which a fork does not
/// have. (Threads that libraries start idle when loaded, as OpenVDB's logging does, are not
/// needed.) Throws UserError for what the user gave (with_late_refusals of bench/scene/scene.h),
/// and std::runtime_error for every other failure of the body.
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
  int repeats = 0;
  std::vector<std::uint64_t> seeds;
  std::vector<MemoryPeak> memory;
  std::vector<RungTime> times;
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
