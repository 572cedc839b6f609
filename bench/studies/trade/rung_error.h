// What a rung leaves out, as errors against the truth and against the rung above.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/studies/trade/rung_time.h"

namespace wobblebench::bench {

/// Ranges of surfaces along sticks against others.
struct DepthSpread {
  double median_mm = 0;       ///< signed
  double median_size_mm = 0;  ///< of the absolute differences
  double p95_size_mm = 0;
  long n = 0;
  double missed_percent = 0;  ///< of the sticks that have one to find
};

struct RungError {
  std::string body;
  sim::Rung rung = sim::Rung::field;
  DepthSpread against_truth;
  /// Against the rung above; none for the highest.
  std::optional<DepthSpread> against_above;
  std::optional<double> image_rms_db;
  std::optional<double> image_correlation;
};

/// The phantom's first target surface along each stick, from the front of its box of interest.
std::vector<double> true_ranges(const TradeScene& scene);

/// `rungs` from the lowest. A surface is found where the mean of three samples first exceeds 0.3
/// of the display, in the volume of the first seed. Images are the mean
/// of what is displayed, over the seeds; they are compared where either shows anything.
std::vector<RungError> measure_rung_errors(const std::string& body,
                                           const TradeScene& scene,
                                           const std::vector<sim::Rung>& rungs,
                                           const std::vector<std::uint64_t>& seeds);

}  // namespace wobblebench::bench
