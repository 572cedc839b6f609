#include "sim/sim_link.h"

#include <algorithm>

#include "hw/wire.h"

namespace wobblebench::sim {

SimLink::SimLink(ProbeSimulator simulator, std::shared_ptr<std::atomic<double>> volume_ms)
    : simulator_(std::move(simulator)), volume_ms_(std::move(volume_ms)) {}

hw::LinkCapabilities SimLink::capabilities() const {
  return {.provenance = hw::Provenance::simulated, .copy_in = true, .waits_for_reader = true};
}

hw::ReadResult SimLink::read(std::span<std::byte> buffer, hw::HostTime) {
  if (closed_) return {0, hw::ReadStatus::lost};
  if (cancelled_) return {0, hw::ReadStatus::cancelled};
  if (read_ == bytes_.size()) {
    bytes_.clear();
    read_ = 0;
    encode_next();
    if (bytes_.empty()) return {0, hw::ReadStatus::end_of_stream};
  }
  const std::size_t count = std::min(buffer.size(), bytes_.size() - read_);
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(read_), count, buffer.begin());
  read_ += count;
  return {count, hw::ReadStatus::ok};
}

void SimLink::begin_volume() {
  const auto& plan = simulator_.plan();
  const std::uint32_t volume = plan.index(sequence_).volume;
  const auto start = hw::HostClock::now();
  volume_ = simulator_.volume(volume);
  if (volume_ms_) {
    *volume_ms_ += std::chrono::duration<double, std::milli>(hw::HostClock::now() - start).count();
  }
  hw::encode(hw::ConfigurationPacket{.sequence = sequence_,
                                     .volume = volume,
                                     .time = plan.stick_time(sequence_),
                                     .source = hw::Provenance::simulated,
                                     .probe = plan.probe(),
                                     .acquisition = plan.acquisition()},
             bytes_);
}

void SimLink::encode_next() {
  const auto& plan = simulator_.plan();
  const auto per_volume = static_cast<std::uint64_t>(plan.sticks_per_volume());
  if (sequence_ == per_volume * static_cast<std::uint64_t>(plan.acquisition().volumes)) return;
  const std::uint64_t place = sequence_ % per_volume;
  if (place == 0) begin_volume();

  const auto samples = static_cast<std::ptrdiff_t>(plan.acquisition().samples_per_stick);
  const auto first = volume_.begin() + static_cast<std::ptrdiff_t>(place) * samples;
  hw::Stick stick;
  stick.sequence = sequence_;
  stick.index = plan.index(sequence_);
  stick.time = plan.stick_time(sequence_);
  stick.motor_angle_rad = plan.motor_angle_rad(stick.index);
  stick.scale = simulator_.options().output;
  stick.samples.assign(first, first + samples);
  hw::encode(stick, bytes_);
  ++sequence_;

  if (place + 1 < per_volume) return;
  hw::encode(
      hw::VolumeEndPacket{
          .sequence = sequence_, .volume = stick.index.volume, .time = plan.stick_time(sequence_)},
      bytes_);
}

}  // namespace wobblebench::sim
