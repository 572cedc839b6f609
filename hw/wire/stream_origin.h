// The source of a stream's samples.
#pragma once

#include <cstdint>
#include <string_view>

namespace wobblebench::hw {

/// The values are those of the wire format.
enum class StreamOrigin : std::uint32_t {
  simulated = 1,  ///< a synthetic probe
  recording = 2,  ///< a file, of any origin
  emulator = 3,   ///< an emulation of the card's driver
  hardware = 4,   ///< a real card
};

/// "simulated", "recording", "stand-in" or "hardware", as in reports.
constexpr std::string_view to_string(StreamOrigin origin) {
  switch (origin) {
    case StreamOrigin::simulated:
      return "simulated";
    case StreamOrigin::recording:
      return "recording";
    case StreamOrigin::emulator:
      return "stand-in";
    case StreamOrigin::hardware:
      return "hardware";
  }
  return "unknown";
}

}  // namespace wobblebench::hw
