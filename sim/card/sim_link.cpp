#include "sim/card/sim_link.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "base/options.h"
#include "hw/wire/packet.h"

namespace wobblebench::sim {
namespace {

using std::chrono::duration;

double milliseconds(hw::HostClock::duration time) {
  return duration<double, std::milli>(time).count();
}

/// Adds the wall time of making each volume to the figures.
VolumeFeed::Make timed(VolumeFeed::Make make, std::shared_ptr<SimLinkFigures> figures) {
  return [make = std::move(make), figures = std::move(figures)](std::uint32_t volume) {
    const auto start = hw::HostClock::now();
    VolumeSamples samples = make(volume);
    figures->volume_ms += milliseconds(hw::HostClock::now() - start);
    return samples;
  };
}

}  // namespace

StickSource stick_source(ProbeSimulator simulator) {
  const hw::AcquisitionPlan plan = simulator.plan();
  const hw::SampleScale scale = simulator.options().output;
  return {plan, scale, [simulator = std::move(simulator)](std::uint32_t volume) {
            return simulator.volume(volume);
          }};
}

SimLink::SimLink(StickSource source,
                 const SimLinkOptions& options,
                 std::shared_ptr<SimLinkFigures> figures,
                 const hw::HostTimeSource* time)
    : source_(std::move(source)),
      options_(options),
      figures_(figures ? std::move(figures) : std::make_shared<SimLinkFigures>()),
      time_(time),
      card_(options.card),
      feed_(timed(source_.volume, figures_),
            static_cast<std::uint32_t>(source_.plan.acquisition().volumes),
            options.volumes_ahead,
            [this] { waiting_.wake(); }),
      stick_period_(std::llround(source_.plan.stick_period_s() * 1e9)) {
  check_options(options_);
}

hw::LinkCapabilities SimLink::capabilities() const {
  return {.origin = hw::StreamOrigin::simulated,
          .copy_in = true,
          .waits_for_reader = options_.pace == hw::Pace::asap,
          .buffer_bytes = static_cast<std::size_t>(options_.card.buffer_bytes),
          .buffers = options_.card.buffers,
          .buffers_per_interrupt = options_.card.buffers_per_interrupt};
}

hw::ReadResult SimLink::read(std::span<std::byte> buffer, hw::HostTime deadline) {
  if (const auto ended = waiting_.interrupted()) return {0, *ended};
  try {
    return read_card(buffer, deadline);
  } catch (const std::exception& error) {
    loss_ = std::string("the simulation failed: ") + error.what();
    return {0, hw::ReadStatus::lost};
  }
}

hw::ReadResult SimLink::read_card(std::span<std::byte> buffer, hw::HostTime deadline) {
  if (!epoch_) epoch_ = now();
  for (;;) {
    const std::uint64_t wakes = waiting_.wakes();
    send_until(device_now());
    figures_->packets_dropped = card_.packets_dropped();
    if (const std::size_t bytes = card_.read(buffer, device_now()); bytes > 0) {
      return {bytes, hw::ReadStatus::ok};
    }
    if (over_ && !card_.next_interrupt()) return {0, hw::ReadStatus::end_of_stream};
    if (deadline <= now()) return {0, hw::ReadStatus::timeout};
    waiting_.sleep_until(std::min(deadline, next_event()), wakes);
    if (const auto ended = waiting_.interrupted()) return {0, *ended};
  }
}

/// asap: all that is announced may be read at once.
hw::DeviceTime SimLink::device_now() const {
  if (options_.pace == hw::Pace::asap) return hw::DeviceTime::max();
  return hw::DeviceTime(now() - *epoch_);
}

/// When something can happen that a read waits for; a volume that becomes ready wakes it besides.
hw::HostTime SimLink::next_event() const {
  if (options_.pace == hw::Pace::asap) return hw::HostTime::max();
  hw::DeviceTime event = hw::DeviceTime::max();
  if (const auto interrupt = card_.next_interrupt()) event = *interrupt;
  if (!over_ && inside_volume_) event = std::min(event, next_complete());
  if (event == hw::DeviceTime::max()) return hw::HostTime::max();
  return *epoch_ + event.time_since_epoch();
}

/// Sends packets that are complete at `time`; asap, until there is something to read.
void SimLink::send_until(hw::DeviceTime time) {
  const bool asap = options_.pace == hw::Pace::asap;
  while (!over_) {
    if (asap && card_.next_interrupt()) return;
    if (!inside_volume_ && !next_volume()) return;
    if (next_complete() > time) return;
    send_packet();
  }
}

/// Begins the next volume if its samples are ready.
bool SimLink::next_volume() {
  if (!feed_.ready()) return false;
  const hw::AcquisitionPlan& plan = source_.plan;
  const hw::DeviceTime begin = plan.stick_time(sequence_);
  auto made = feed_.take();
  volume_ = std::move(made.samples);
  hold_up(begin, made.at);
  bytes_.clear();
  hw::encode(hw::ConfigurationPacket{.sequence = sequence_,
                                     .volume = plan.index(sequence_).volume,
                                     .time = begin,
                                     .source = hw::StreamOrigin::simulated,
                                     .probe = plan.probe(),
                                     .acquisition = plan.acquisition()},
             bytes_);
  card_.put(bytes_, begin, false);
  inside_volume_ = true;
  return true;
}

/// A probe whose samples come late waits for them; the first volume is not late, it is the start.
void SimLink::hold_up(hw::DeviceTime begin, hw::HostTime ready) {
  const hw::HostTime due = *epoch_ + begin.time_since_epoch();
  if (time_ != nullptr || ready <= due) return;
  *epoch_ += ready - due;
  if (sequence_ > 0) figures_->late_ms += milliseconds(ready - due);
}

hw::DeviceTime SimLink::next_complete() const {
  return source_.plan.stick_time(sequence_) + stick_period_;
}

void SimLink::send_packet() {
  const hw::AcquisitionPlan& plan = source_.plan;
  const auto samples = static_cast<std::size_t>(plan.acquisition().samples_per_stick);
  const auto per_volume = static_cast<std::uint64_t>(plan.sticks_per_volume());
  const std::uint64_t place = sequence_ % per_volume;
  const auto mine = std::span(volume_).subspan(place * samples, samples);
  stick_.sequence = sequence_;
  stick_.index = plan.index(sequence_);
  stick_.time = plan.stick_time(sequence_);
  stick_.motor_angle_rad = plan.motor_angle_rad(stick_.index);
  stick_.sweep_direction = plan.sweep_direction(stick_.index.volume);
  stick_.scale = source_.scale;
  stick_.samples.assign(mine.begin(), mine.end());
  bytes_.clear();
  hw::encode(stick_, bytes_);
  card_.put(bytes_, next_complete(), false);
  ++sequence_;
  ++figures_->sticks_emitted;
  if (place + 1 == per_volume) end_volume(stick_.index.volume);
}

void SimLink::end_volume(std::uint32_t volume) {
  const hw::DeviceTime end = source_.plan.volume_end_time(volume);
  bytes_.clear();
  hw::encode(hw::VolumeEndPacket{.sequence = sequence_, .volume = volume, .time = end}, bytes_);
  card_.put(bytes_, end, true);
  inside_volume_ = false;
  over_ = volume + 1 == static_cast<std::uint32_t>(source_.plan.acquisition().volumes);
}

}  // namespace wobblebench::sim
