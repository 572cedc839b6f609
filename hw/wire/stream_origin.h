// Where the samples of a stream come from.
#pragma once

#include <cstdint>
#include <string_view>

namespace wobblebench::hw {

/// On the wire as its number.
enum class Provenance : std::uint32_t {
  simulated = 1,  ///< a synthetic probe
  recording = 2,  ///< a file, whatever filled it
  stand_in = 3,   ///< something that behaves like the card's driver
  hardware = 4,   ///< a card
};

/// "simulated", "recording", "stand-in" or "hardware", as reports say it.
constexpr std::string_view to_string(Provenance provenance) {
  switch (provenance) {
    case Provenance::simulated:
      return "simulated";
    case Provenance::recording:
      return "recording";
    case Provenance::stand_in:
      return "stand-in";
    case Provenance::hardware:
      return "hardware";
  }
  return "unknown";
}

}  // namespace wobblebench::hw
