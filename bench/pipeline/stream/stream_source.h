// What a stream is read from, and its samples as the renderer takes them: log-compressed, 0 to 1
// over the dynamic range.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "hw/board/board.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/probe/motor_deviation.h"
#include "hw/probe/polar_volume.h"
#include "hw/wire/configuration.h"

namespace wobblebench::bench {

/// Longer than any volume takes to arrive.
inline constexpr std::chrono::minutes kVolumeTimeout{10};

struct StreamSource {
  hw::Board& board;          ///< not running
  hw::AcquisitionPlan plan;  ///< the board's
  std::string name;          ///< --board, for refusals
  /// Where first_configuration() took it from the board; else it is the first event.
  std::optional<hw::Configuration> configuration;
  hw::BoardAccount before_configuration = {};  ///< sticks that were lost before that was taken
  /// Over which linear envelopes of that scale are log-compressed. Empty: over the one that it
  /// states; where it states none they are refused.
  std::function<double(const hw::DisplayScale&)> dynamic_range_db;

  /// hw::Configuration::knows_times; the simulator does.
  bool knows_times() const { return !configuration || configuration->knows_times; }
};

/// what() is one line, "--board NAME: no … came; WHY".
class NothingCame : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct FirstConfiguration {
  hw::Configuration configuration;
  hw::BoardAccount before;  ///< sticks that were lost before it
};
/// Starts the board, takes its first configuration, and stops it: sticks that a source at its own
/// pace sends until it is started again are missed, and counted. Throws NothingCame, after
/// kVolumeTimeout at the latest.
FirstConfiguration first_configuration(hw::Board& board, const std::string& name);

/// Why nothing more comes, of EndOfStream and DeviceLost; empty: of other events.
std::string ending_of(const hw::Event& event);
/// `what` did not come: the stream ended for a reason, or it did not end (empty).
NothingCame nothing_came(const std::string& name, const std::string& what, std::string ending);

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

/// Log-compresses linear envelopes, which are 1 at full scale, over `dynamic_range_db`; nullopt:
/// over that of the configuration's display scale. Throws UserError "--board = ARGS: …" where the
/// full scale is not known (of hardware that states no display scale), or no dynamic range is, and
/// for samples of another scale than 0 to 1.
ReceivedSamples make_displayable(hw::PolarVolume& volume,
                                 const hw::Configuration& configuration,
                                 std::optional<double> dynamic_range_db,
                                 const std::string& board);

/// Throws UserError "--board = NAME: …" where hardly a stick of a volume lies in the plan's fan.
void refuse_misplaced(const hw::MotorDeviation& motor,
                      const hw::AcquisitionPlan& plan,
                      const std::string& board);

}  // namespace wobblebench::bench
