// What the times of a stream's pictures say: ages, rates, and what limits them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/pipeline/stream/stream.h"

namespace wobblebench::bench {

/// Observed values (quantile_upper of base/statistics.h), ms.
struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0, p999 = 0, max = 0;
  std::size_t n = 0;
};
/// NaN without values.
Percentiles percentiles_of(const std::vector<double>& values_ms);

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
  /// The parts of age_newest, in order. The first is none unless `scheduled`.
  std::optional<Percentiles> fired_to_acquired;
  /// Of it, by the simulator's model of the card: until the interrupt that announces a volume's
  /// last stick, the same in each volume.
  std::optional<double> fired_to_announced_ms;
  Percentiles acquired_to_rendering;  ///< pass 1 is done, pass 2 begins
  Percentiles rendering;              ///< passes 2 to 4, with reading back
  Percentiles ready_to_written;
  double seconds = 0;        ///< from the first picture to the last
  double volumes_per_s = 0;  ///< shown
  double pictures_per_s = 0;
  Percentiles interval;          ///< between pictures
  double jitter_ms = 0;          ///< standard deviation of the interval
  std::vector<StageLoad> loads;  ///< the heaviest first
};

/// `sound_ms`: one volume of the schedule, in real time; 0: the source goes as fast as it can.
/// `simulator_ms`: computing one volume; 0: none is.
StreamSummary summarize(const StreamResult& result, double sound_ms, double simulator_ms);

/// The heaviest stage, and how many times the next one's time it takes.
struct Bottleneck {
  std::string stage;
  double times_the_next = 0;
};
Bottleneck bottleneck_of(const StreamSummary& summary);

}  // namespace wobblebench::bench
