// The figures of times: of a picture, of a stream's pictures, and of the program itself.
#pragma once

#include "bench/results/measure.h"

namespace wobblebench::bench::times {

inline constexpr Measure kFrame{
    "frame_ms", "picture", "All passes of a picture; of a stream the renderer's mean a volume"};
inline constexpr Measure kVolume{
    "volume_ms", "new volume", "All passes of the picture of a new volume"};
inline constexpr Measure kView{"view_ms", "new view", "Passes 2 to 4 of the same volume's picture"};
inline constexpr Measure kVolumeRatio{
    "volume_ratio", "new volume", "Time over that of the reference's picture"};
inline constexpr Measure kViewRatio{
    "view_ratio", "new view", "Time over that of the reference's picture"};
inline constexpr Measure kSimulation{"simulation_ms", "simulation", "Simulating a volume"};
inline constexpr Measure kRun{"run_ms", "command", "Wall time of all steps"};
inline constexpr Measure kCpu{"cpu_ms", "CPU", "CPU time of the whole process"};

// Of what a stream's pictures take.
inline constexpr Measure kP50{"p50_ms", "P50", "Of 50 % of the pictures at most"};
inline constexpr Measure kP90{"p90_ms", "P90", "Of 90 %"};
inline constexpr Measure kP99{"p99_ms", "P99", "Of 99 %"};
inline constexpr Measure kP999{"p999_ms", "P99.9", "Of 99.9 %"};
inline constexpr Measure kMax{"max_ms", "max", "Of all pictures at most"};
inline constexpr Measure kN{"n", "pictures", "Pictures with such a time", Worse::neither};
inline constexpr Measure kJitter{
    "jitter_ms", "deviation", "Standard deviation of the time between pictures"};
inline constexpr Measure kSeconds{
    "seconds", "seconds", "From the first picture to the last", Worse::neither};
inline constexpr Measure kVolumesPerS{
    "volumes_per_s", "volumes", "Whole volumes shown a second", Worse::lower};
inline constexpr Measure kPicturesPerS{
    "pictures_per_s", "pictures", "Pictures shown a second", Worse::lower};

inline constexpr const Measure* kAll[] = {&kFrame,
                                          &kVolume,
                                          &kView,
                                          &kVolumeRatio,
                                          &kViewRatio,
                                          &kSimulation,
                                          &kRun,
                                          &kCpu,
                                          &kP50,
                                          &kP90,
                                          &kP99,
                                          &kP999,
                                          &kMax,
                                          &kN,
                                          &kJitter,
                                          &kSeconds,
                                          &kVolumesPerS,
                                          &kPicturesPerS};

}  // namespace wobblebench::bench::times
