#include "hw/link/device_gone.h"

#include <algorithm>
#include <utility>

namespace wobblebench::hw {

DeviceGoneDetector::Result DeviceGoneDetector::inspect(std::span<const std::byte> transfer) {
  const auto is_other = [](std::byte value) { return value != std::byte{0xFF}; };
  const auto first = std::find_if(transfer.begin(), transfer.end(), is_other);
  const auto leading = static_cast<std::size_t>(first - transfer.begin());
  if (run_ + leading > kLongestValidOnes) return {.gone = true};
  if (first == transfer.end()) {
    run_ += leading;
    held_back_ += leading;
    return {};
  }
  const auto last = std::find_if(transfer.rbegin(), transfer.rend(), is_other);
  run_ = static_cast<std::size_t>(last - transfer.rbegin());
  const std::size_t released = std::exchange(held_back_, 0);
  const bool gone = run_ > kLongestValidOnes;
  return {released, transfer.size() - (gone ? run_ : 0), gone};
}

std::size_t DeviceGoneDetector::end() {
  return std::exchange(held_back_, 0);
}

}  // namespace wobblebench::hw
