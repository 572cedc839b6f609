// Detects that a card has left the PCIe bus: every byte read from it is then 0xFF.
#pragma once

#include <cstddef>
#include <span>

#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// Longest run of 0xFF in valid packets, bytes: a header, and samples that are all NaN.
inline constexpr std::size_t kLongestValidOnes = kWireHeaderBytes + 4 * kWireMaxSamples;

/// Inspects transfers in order. Transfers of 0xFF only are held back until it is known whether they
/// are samples or the card is gone. Not thread-safe.
class DeviceGoneDetector {
 public:
  struct Result {
    std::size_t held_back = 0;  ///< bytes of 0xFF of earlier transfers, to pass on first
    std::size_t valid = 0;      ///< leading bytes of this transfer to pass on
    bool gone = false;          ///< the card has left the bus
  };

  [[nodiscard]] Result inspect(std::span<const std::byte> transfer);

  /// At the end of the stream: number of bytes of 0xFF that are held back, to pass on.
  [[nodiscard]] std::size_t end();

 private:
  std::size_t run_ = 0;        ///< bytes of 0xFF at the end of the stream so far
  std::size_t held_back_ = 0;  ///< of these
};

}  // namespace wobblebench::hw
