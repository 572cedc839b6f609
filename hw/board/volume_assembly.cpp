#include "hw/board/volume_assembly.h"

#include <utility>

namespace wobblebench::hw {

bool VolumeAssembly::wait_for_configuration(HostTime deadline) {
  while (!configuration_) {
    Event event = board_.next(deadline);
    if (auto* configuration = std::get_if<Configuration>(&event)) {
      configuration_ = *configuration;
    } else if (!std::holds_alternative<Gap>(event)) {
      // No stick comes before the first configuration.
      ended_ =
          !std::holds_alternative<TimedOut>(event) && !std::holds_alternative<Cancelled>(event);
      return false;
    }
  }
  return true;
}

std::optional<PolarVolume> VolumeAssembly::next(HostTime deadline) {
  ended_ = false;
  for (;;) {
    Event event = board_.next(deadline);
    if (const auto* slot = std::get_if<StickSlot>(&event)) {
      if (auto finished = add(**slot)) return finished;
    } else if (auto* configuration = std::get_if<Configuration>(&event)) {
      configuration_ = *configuration;
      if (volume_) return std::exchange(volume_, std::nullopt);
    } else if (std::holds_alternative<VolumeEnd>(event)) {
      if (volume_) return std::exchange(volume_, std::nullopt);
    } else if (std::holds_alternative<TimedOut>(event) ||
               std::holds_alternative<Cancelled>(event)) {
      return {};
    } else if (!std::holds_alternative<Gap>(event)) {
      ended_ = true;
      return std::exchange(volume_, std::nullopt);
    }
  }
}

/// Returns the current volume if the stick belongs to another.
std::optional<PolarVolume> VolumeAssembly::add(const Stick& stick) {
  std::optional<PolarVolume> finished;
  if (volume_ && volume_->volume_index() != stick.index.volume) {
    finished = std::exchange(volume_, std::nullopt);
  }
  if (!volume_) volume_.emplace(configuration_.value().plan, stick.index.volume);
  volume_->place(stick);
  return finished;
}

}  // namespace wobblebench::hw
