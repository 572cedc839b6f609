#include "hw/recording/file_link.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <string>
#include <variant>

#include "base/options.h"

namespace wobblebench::hw {
namespace {

/// No time of a sound recording is further from its first; a wilder one does not stop the clock.
constexpr DeviceDuration kLongestRecording = std::chrono::hours(24 * 365);

/// `duration` is not negative.
DeviceTime saturated_sum(DeviceTime time, DeviceDuration duration) {
  return time > DeviceTime::max() - duration ? DeviceTime::max() : time + duration;
}

}  // namespace

FileLink::FileLink(const std::filesystem::path& path, const FileLinkOptions& options)
    : options_(options), file_(path) {
  check_options(options);
  if (options.start_volume > 0) {
    start_ = find_volume(static_cast<std::uint32_t>(options.start_volume));
  }
  if (options.loop) turn_ = measure_turn();
  offset_ = start_;
  reader_.emplace(file_, start_);
}

LinkCapabilities FileLink::capabilities() const {
  return {.origin = StreamOrigin::recording, .copy_in = true, .waits_for_reader = true};
}

std::uint64_t FileLink::find_volume(std::uint32_t volume) const {
  RecordingReader reader(file_);
  std::optional<std::uint32_t> last;
  while (const auto recorded = reader.next()) {
    if (!recorded->packet) continue;
    const auto* packet = std::get_if<ConfigurationPacket>(&*recorded->packet);
    if (packet == nullptr) continue;
    if (packet->volume == volume) return recorded->offset;
    last = packet->volume;
  }
  throw InvalidOption(
      "start_volume",
      std::to_string(volume),
      "no volume of " + file_.path().string() +
          (last ? ", whose last is " + std::to_string(*last) : ", which holds no configuration"));
}

FileLink::Turn FileLink::measure_turn() {
  const auto refuse = [&](const std::string& why) {
    throw InvalidOption("loop", "true", file_.path().string() + " cannot be repeated: " + why);
  };
  RecordingReader reader(file_, start_);
  std::optional<ConfigurationPacket> first;
  std::uint32_t last = 0;
  while (const auto recorded = reader.next()) {
    if (!recorded->packet) continue;
    if (const auto* packet = std::get_if<ConfigurationPacket>(&*recorded->packet)) {
      if (!first) first = *packet;
      if (!(first->probe == packet->probe) || !(first->acquisition == packet->acquisition)) {
        refuse("it holds several acquisitions");
      }
      last = std::max(last, packet->volume);
    } else if (const auto* stick = std::get_if<StickPacket>(&*recorded->packet)) {
      last = std::max(last, stick->stick.index.volume);
    }
  }
  if (!first) refuse("it holds no configuration");
  plan_.emplace(first->probe, first->acquisition);
  Turn turn;
  turn.volumes = last - std::min(last, first->volume) + 1;
  if (first->acquisition.motor == MotorMode::alternating && turn.volumes % 2 != 0) {
    refuse("the motor alternates, and it holds an odd number of volumes");
  }
  turn.sticks = static_cast<std::uint64_t>(plan_->sticks_per_volume()) * turn.volumes;
  return turn;
}

ReadResult FileLink::read(std::span<std::byte> buffer, HostTime deadline) {
  if (const auto ended = waiting_.ended()) return {0, *ended};
  try {
    const bool as_it_is = options_.pace == Pace::asap && !options_.loop;
    return as_it_is ? read_raw(buffer) : read_packets(buffer, deadline);
  } catch (const std::exception& error) {
    loss_ = error.what();
    return {0, ReadStatus::lost};
  }
}

ReadResult FileLink::read_raw(std::span<std::byte> buffer) {
  const std::size_t count = file_.read(offset_, buffer);
  offset_ += count;
  return {count, count > 0 ? ReadStatus::ok : ReadStatus::end_of_stream};
}

ReadResult FileLink::read_packets(std::span<std::byte> buffer, HostTime deadline) {
  while (as_it_is_ == 0 && given_ == packet_.size()) {
    if (!take_packet()) return {0, ReadStatus::end_of_stream};
  }
  if (as_it_is_ > 0) {
    const auto most = std::min<std::uint64_t>(buffer.size(), as_it_is_);
    const ReadResult result = read_raw(buffer.first(static_cast<std::size_t>(most)));
    as_it_is_ = result.status == ReadStatus::ok ? as_it_is_ - result.bytes : 0;
    return result;
  }
  if (options_.pace == Pace::realtime && packet_due_ > HostClock::now()) {
    waiting_.sleep_until(std::min(packet_due_, deadline));
    if (const auto ended = waiting_.ended()) return {0, *ended};
    if (packet_due_ > HostClock::now()) return {0, ReadStatus::timeout};
  }
  const std::size_t count = std::min(buffer.size(), packet_.size() - given_);
  std::copy_n(packet_.begin() + static_cast<std::ptrdiff_t>(given_), count, buffer.begin());
  given_ += count;
  return {count, ReadStatus::ok};
}

/// Takes the next packet, and the damage before it. False at the end.
bool FileLink::take_packet() {
  if (!reader_) return false;
  given_ = 0;
  packet_.clear();
  const auto recorded = reader_->next();
  if (!recorded) {
    take_end();
    return true;
  }
  as_it_is_ = recorded->damage_before;
  offset_ = recorded->offset - as_it_is_;
  packet_.assign(recorded->bytes.begin(), recorded->bytes.end());
  PacketStamp stamp = packet_stamp(packet_);
  if (options_.loop) {
    stamp.sequence += done_.sticks;
    stamp.volume += done_.volumes;
    // From the start each time, so that no rounding adds up.
    stamp.time = saturated_sum(stamp.time, plan_->stick_time(done_.sticks).time_since_epoch());
    restamp(packet_, stamp);
  }
  packet_due_ = due(stamp.time);
  return true;
}

/// Takes the damage at the end, and turns back where the recording is repeated.
void FileLink::take_end() {
  as_it_is_ = reader_->damage_at_end();
  offset_ = file_.bytes() - as_it_is_;
  reader_.reset();
  if (!options_.loop) return;
  done_.sticks += turn_.sticks;
  done_.volumes += turn_.volumes;
  reader_.emplace(file_, start_);
}

HostTime FileLink::due(DeviceTime time) {
  if (!epoch_) epoch_ = {HostClock::now(), time};
  const DeviceTime last = saturated_sum(epoch_->device, kLongestRecording);
  return epoch_->host + (std::clamp(time, epoch_->device, last) - epoch_->device);
}

}  // namespace wobblebench::hw
