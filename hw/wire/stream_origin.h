// Where the samples of a stream come from.
#pragma once

#include <cstdint>
#include <string_view>

namespace wobblebench::hw {

/// On the wire as its number.
enum class StreamOrigin : std::uint32_t {
  simulated = 1,  ///< a synthetic probe
  recording = 2,  ///< a file, whatever filled it
  emulator = 3,   ///< something that behaves like the card's driver
  hardware = 4,   ///< a card
};

/// "simulated", "recording", "stand-in" or "hardware", as reports say it.
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
