// Acquisition against rendering: what limits a stream, predicted in virtual time and held against
// the wall clock.
#pragma once

#include <string>
#include <vector>

#include "base/part_done.h"
#include "base/statistics.h"
#include "bench/cache/phantom_cache.h"
#include "bench/pipeline/stream/stream_summary.h"
#include "bench/scene/scene.h"
#include "bench/studies/latency/virtual_stream.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// A figure over random draws of service times: 95 % of its values lie between low and high.
struct Drawn {
  double median = 0, low = 0, high = 0;
};

/// One setting on both clocks. Ages are of the newest echo, from its scheduled emission until the
/// picture is ready.
struct LatencyCheck {
  std::string name;
  bool calibrated_on = false;  ///< the service times were measured at this setting
  double sound_ms = 0;         ///< one volume
  Percentiles wall;
  /// From virtual streams as long as those on the wall: P99 of so few pictures is a matter of
  /// chance.
  Drawn predicted_p50_ms, predicted_p99_ms;
  double wall_volumes_per_s = 0, predicted_volumes_per_s = 0;
  double wall_renderer_ms = 0, predicted_renderer_ms = 0;  ///< one volume, mean
};

/// From the end of a stall until a picture's age is back within the 90th percentile before it.
struct StallRecovery {
  double stall_ms = 0;
  double wall_ms = 0, predicted_ms = 0;  ///< NaN: not before the stream's end
  double wall_worst_ms = 0,
         predicted_worst_ms = 0;  ///< greatest age of the newest echo after the stall
};

/// The least number of frames a volume from which on sound takes longer than rendering.
struct CrossoverCurve {
  std::string times;  ///< whose
  int lines = 0;
  std::vector<double> depth_mm;
  std::vector<double> frames;  ///< NaN: sound never does
};

struct LatencyStudy {
  int volumes = 0;  ///< of each wall-clock stream, warm-up included
  int rounds = 0;   ///< streams of each setting
  StreamPolicy policy = StreamPolicy::newest;
  ServiceTimes times;     ///< of the scene's own setting
  StreamSummary summary;  ///< of the scene's first stream
  std::vector<LatencyCheck> checks;
  std::vector<StallRecovery> stalls;
  std::vector<CrossoverCurve> crossovers;
  std::vector<LineRate> line_rates;
  double scene_line_rate_per_s = 0;
};

/// Streams the scene in real time, and with half its frames: service times follow. Then streams
/// with three quarters of the frames, half as many lines again and three quarters of the depth, and
/// with stalls, on both clocks. All but those with stalls are streamed three times, in turn. Throws
/// InvalidOption for what the changed scenes cannot be.
LatencyStudy study_latency(const Scene& scene,
                           int volumes,
                           StreamPolicy policy,
                           render::GlContext& context,
                           PhantomCache& cache,
                           const PartDone& done = {});

/// Curves of service times that are known, without a stream.
std::vector<CrossoverCurve> crossover_curves(const std::string& name,
                                             const ServiceTimes& one,
                                             int frames_of_one,
                                             const ServiceTimes& other,
                                             int frames_of_other,
                                             const hw::AcquisitionPlan& plan);

}  // namespace wobblebench::bench
