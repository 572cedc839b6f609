// What the times of a stream's pictures say: ages, rates, and what limits them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/stream/latency_spans.h"
#include "bench/pipeline/stream/stream.h"

namespace wobblebench::bench {

/// How long one stage works for each volume; stages work at the same time.
struct StageLoad {
  std::string stage;
  double ms_per_volume = 0;
};

struct StreamSummary {
  /// Whether ages count from the time at which the schedule fired a stick; else, of a device with
  /// a clock of its own, or as fast as it goes, from when the stick was acquired.
  bool scheduled = false;
  /// From the first and from the last stick of a picture's volume until the picture is ready.
  Percentiles age_oldest, age_newest;
  LatencySpans spans;  ///< of both
  Percentiles ready_to_written;
  double seconds = 0;        ///< from the first picture to the last
  double volumes_per_s = 0;  ///< shown
  double pictures_per_s = 0;
  Percentiles interval;          ///< between pictures
  double jitter_ms = 0;          ///< standard deviation of the interval
  std::vector<StageLoad> loads;  ///< the heaviest first
};

/// `sound_ms`: one volume of the schedule, in real time; 0: the source goes as fast as it can.
/// `simulator_ms`: computing one volume; 0: none is. `card`: as latency_spans() takes it.
StreamSummary summarize(const StreamResult& result,
                        double sound_ms,
                        double simulator_ms,
                        const std::optional<CardDelays>& card = {});

/// The heaviest stage, and how many times the next one's time it takes.
struct Bottleneck {
  std::string stage;
  double times_the_next = 0;
};
Bottleneck bottleneck_of(const StreamSummary& summary);

}  // namespace wobblebench::bench
