// Samples as the renderer takes them: log-compressed, 0 to 1 over the dynamic range.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "hw/probe/polar_volume.h"
#include "hw/wire/stream_origin.h"

namespace wobblebench::bench {

/// What the samples of a volume were, of the sticks that arrived.
struct ReceivedSamples {
  hw::SampleScale scale = hw::SampleScale::log_compressed;
  float least = 0, most = 0;  ///< of those that are finite
  std::uint64_t count = 0;
  /// Not finite, negative, or log-compressed and above 1: the renderer clamps them.
  std::uint64_t out_of_range = 0;
  /// Over which linear envelopes were log-compressed; unset: they were not linear.
  std::optional<double> dynamic_range_db;
};

/// More samples out of range than these are no outliers: the source counts on another scale.
inline constexpr double kMostOutOfRangePercent = 1;

/// Log-compresses linear envelopes of a simulation, whose full scale is 1. Throws UserError
/// "--board = ARGS: …" where the full scale is not known (of hardware; or no dynamic range is
/// given), and for samples of another scale than 0 to 1.
ReceivedSamples make_displayable(hw::PolarVolume& volume,
                                 hw::StreamOrigin source,
                                 std::optional<double> dynamic_range_db,
                                 const std::string& board);

}  // namespace wobblebench::bench
