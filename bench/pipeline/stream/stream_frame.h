// What travels from the board to the renderer: frames, each with the times of its sticks.
#pragma once

#include <cstdint>
#include <optional>

#include "hw/probe/clock.h"
#include "hw/probe/polar_volume.h"

namespace wobblebench::bench {

/// The host's clock throughout. `fired`: scheduled, by the link's epoch; unset where the device has
/// a clock of its own.
struct StickTimes {
  std::optional<hw::HostTime> fired;
  hw::HostTime received;  ///< by the board, which the device notified (StickSlot::received())
  hw::HostTime acquired;  ///< taken from the board
  hw::HostTime placed;    ///< copied into its frame
  bool arrived = true;    ///< false: all times but `fired` are those of the nearest that did
};

struct StreamFrame {
  std::uint32_t volume = 0;
  int frame = 0;
  hw::PolarFrame samples;
  int sticks = 0;  ///< that arrived
  /// Of the first and the last line. Where no line arrived, their times are when that was known.
  StickTimes first, last;
  hw::HostTime complete;     ///< its last line was placed, or was known not to come
  bool ends_volume = false;  ///< the last that the volume will get
};

}  // namespace wobblebench::bench
