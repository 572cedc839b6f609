// What the times of a stream's pictures say: ages, rates, and what limits them.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/stream/stream.h"

namespace wobblebench::bench {

/// Quantiles of the times of a stage, ms.
struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0;
  std::size_t n = 0;
};
/// NaN without values.
Percentiles percentiles_of(const std::vector<double>& values_ms);

/// Delays after a stick was fired, by a model of the card; the same in each volume. On the device's
/// clock.
struct CardDelay {
  double dma_complete_ms = 0;  ///< its last byte lies in the host's memory
  double interrupt_ms = 0;     ///< that announces it
};
/// Delays of a volume's first and last stick.
struct CardDelays {
  CardDelay first, last;
};

/// On one clock. Where `from` is on the device's and `to` on the host's, the link's epoch says what
/// `from` is on the host's.
struct LatencySpan {
  std::string from, to;
  bool on_device_clock = false;
  std::optional<Percentiles> ms;  ///< none: the link does not tell
};

/// The age of an echo, from its scheduled emission to the picture that shows it, as spans that
/// follow each other. Only of sticks that arrived.
struct LatencySpans {
  std::vector<LatencySpan> oldest;  ///< of a volume's first stick, until it is acquired
  std::vector<LatencySpan> newest;  ///< of its last one, until the picture is ready
  std::string why_unknown;          ///< empty: all are known
};

/// `card`: none: the link has no model of one, or pictures show parts of a volume.
LatencySpans latency_spans(const StreamResult& result, const std::optional<CardDelays>& card);

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
