#include "hw/board/volume_assembly.h"

#include <stdexcept>
#include <variant>

namespace wobblebench::hw {

namespace {

std::uint64_t& lost_by(LossCause cause, BoardAccount::Lost& lost) {
  switch (cause) {
    case LossCause::ring_full:
      return lost.ring_full;
    case LossCause::link:
      return lost.link;
    case LossCause::corrupt:
      return lost.corrupt;
    case LossCause::out_of_order:
      return lost.out_of_order;
  }
  throw std::logic_error("unknown cause of loss");
}

}  // namespace

void count_lost(const Gap& gap, BoardAccount& account) {
  account.emitted += gap.count;
  lost_by(gap.cause, account.lost) += gap.count;
}

bool VolumeAssembly::wait_for_configuration(HostTime deadline) {
  while (!configuration_) {
    Event event = board_.next(deadline);
    if (auto* configuration = std::get_if<Configuration>(&event)) {
      configuration_ = *configuration;
    } else if (const auto* gap = std::get_if<Gap>(&event)) {
      count_lost(*gap, before_configuration_);
    } else if (!std::holds_alternative<VolumeEnd>(event)) {
      // No stick comes before the first configuration; the end of its volume may.
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
      std::optional<PolarVolume> finished;
      if (is_of_another_volume(**slot)) finished = take_volume();
      place(**slot);
      if (finished) return finished;
    } else if (auto* configuration = std::get_if<Configuration>(&event)) {
      configuration_ = *configuration;
      if (volume_) return take_volume();
    } else if (std::holds_alternative<VolumeEnd>(event)) {
      if (volume_) return take_volume();
    } else if (std::holds_alternative<TimedOut>(event) ||
               std::holds_alternative<Cancelled>(event)) {
      return {};
    } else if (!std::holds_alternative<Gap>(event)) {
      ended_ = true;
      return take_volume();
    }
  }
}

void VolumeAssembly::begin_volume(std::uint32_t index) {
  volume_.emplace(configuration_.value().plan, index);
  finished_frames_ = 0;
}

void VolumeAssembly::place(const Stick& stick) {
  if (!volume_) begin_volume(stick.index.volume);
  volume_->place(stick);
}

int VolumeAssembly::mirrored(int frame) const {
  const AcquisitionPlan& plan = volume_->plan();
  return plan.sweep_direction(volume_->volume_index()) > 0
             ? frame
             : plan.acquisition().frames_per_volume - 1 - frame;
}

int VolumeAssembly::unfinished_frames() const {
  if (!volume_) return 0;
  return volume_->plan().acquisition().frames_per_volume - finished_frames_;
}

bool VolumeAssembly::is_of_later_frame(const Stick& stick) const {
  return volume_ && finished_frames_ < mirrored(static_cast<int>(stick.index.frame));
}

int VolumeAssembly::finish_frame() {
  return mirrored(finished_frames_++);
}

}  // namespace wobblebench::hw
