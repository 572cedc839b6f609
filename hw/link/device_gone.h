// How a card shows that it has left the bus: every byte read from it is 0xFF.
#pragma once

#include <cstddef>
#include <span>

#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// No packet holds a longer run of 0xFF: a header, and samples that are all not-a-number.
inline constexpr std::size_t kLongestValidOnes = kWireHeaderBytes + 4 * kWireMaxSamples;

/// Looks at transfers one after the other. What is nothing but ones is held back, until it shows
/// to be samples or the card to be gone. Not thread-safe.
class DeviceGoneDetector {
 public:
  struct Verdict {
    std::size_t held_back = 0;  ///< bytes of 0xFF of earlier transfers, to hand on first
    std::size_t sound = 0;      ///< bytes of this transfer, from its first, to hand on
    bool gone = false;          ///< the card is
  };

  Verdict look_at(std::span<const std::byte> transfer);

  /// There will be nothing more: the bytes of 0xFF that are held back.
  std::size_t end();

 private:
  std::size_t run_ = 0;        ///< the stream ends with as many ones
  std::size_t held_back_ = 0;  ///< of those
};

}  // namespace wobblebench::hw
