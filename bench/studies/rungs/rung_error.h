// Errors of a rung against the truth and against the next higher rung.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/studies/rungs/rung_time.h"

namespace wobblebench::bench {

/// Detected ranges of a surface along sticks less the expected ones.
struct RangeError {
  double median_mm = 0;      ///< signed
  double median_abs_mm = 0;  ///< of the absolute differences
  double p95_abs_mm = 0;
  long n = 0;
  double missed_percent = 0;  ///< of the sticks that meet the surface
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

}  // namespace wobblebench::bench
