// What a stream is read from.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "hw/board/board.h"
#include "hw/probe/acquisition_plan.h"

namespace wobblebench::bench {

/// Longer than any volume takes to arrive.
inline constexpr std::chrono::minutes kVolumeTimeout{10};

struct StreamSource {
  hw::Board& board;          ///< not running
  hw::AcquisitionPlan plan;  ///< the board's
  std::string name;          ///< --board, for refusals
  /// Where first_configuration() took it from the board; else it is the first event.
  std::optional<hw::Configuration> configuration;
  /// Over which linear envelopes of that scale are log-compressed. Empty: they are refused.
  std::function<double(const hw::DisplayScale&)> dynamic_range_db;
};

/// what() is one line, "--board NAME: no … came; WHY".
class NothingCame : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Starts the board, takes its first configuration, and stops it: sticks that a source at its own
/// pace sends until it is started again are missed, and counted. Throws NothingCame, after
/// kVolumeTimeout at the latest.
hw::Configuration first_configuration(hw::Board& board, const std::string& name);

/// Why nothing more comes, of EndOfStream and DeviceLost; empty: of other events.
std::string ending_of(const hw::Event& event);
/// `what` did not come: the stream ended for a reason, or it did not end (empty).
NothingCame nothing_came(const std::string& name, const std::string& what, std::string ending);

}  // namespace wobblebench::bench
