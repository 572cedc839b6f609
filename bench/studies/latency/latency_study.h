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
#include "bench/studies/latency/service_times.h"
#include "bench/studies/latency/virtual_stream.h"
#include "render/gl/context.h"

namespace wobblebench::bench {

/// A figure over random draws of service times: 95 % of its values lie between low and high.
struct Drawn {
  double median = 0, low = 0, high = 0;
};

/// What virtual streams show. Ages are of the newest echo, from its scheduled emission until the
/// picture is ready.
struct Prediction {
  Drawn p50_ms, p99_ms;
  double volumes_per_s = 0;
  double renderer_ms = 0;  ///< one volume, mean
};

/// One setting on both clocks.
struct LatencyCheck {
  std::string name;
  bool calibrated_on = false;  ///< the service times were measured at this setting
  double sound_ms = 0;         ///< one volume
  Percentiles wall;            ///< of ages as in Prediction
  double wall_volumes_per_s = 0;
  double wall_renderer_ms = 0;  ///< one volume, mean
  /// From virtual streams as long as those on the wall: P99 of so few pictures is a matter of
  /// chance.
  Prediction predicted;
};

/// The scene's stream by the service times of another machine. Waking up and writing take none:
/// they are not known.
struct WhatIf {
  std::string times;  ///< whose
  Prediction predicted;
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
  std::vector<CrossoverCurve> crossovers;  ///< of this machine, the paper's and the known ones
  std::vector<WhatIf> what_ifs;            ///< of the known ones
  std::vector<LineRate> line_rates;
  double scene_line_rate_per_s = 0;
};

/// Streams the scene in real time, and with half its frames: service times follow. Then streams
/// with three quarters of the frames, half as many lines again and three quarters of the depth, and
/// with stalls, on both clocks. All but those with stalls are streamed three times, in turn.
/// `known`: service times of other machines. Throws InvalidOption for what the changed scenes
/// cannot be.
LatencyStudy study_latency(const Scene& scene,
                           int volumes,
                           StreamPolicy policy,
                           const std::vector<KnownTimes>& known,
                           render::GlContext& context,
                           PhantomCache& cache,
                           const PartDone& done = {});

/// Curves of service times that are known, without a stream.
std::vector<CrossoverCurve> crossover_curves(const KnownTimes& known,
                                             const hw::AcquisitionPlan& plan);

}  // namespace wobblebench::bench
