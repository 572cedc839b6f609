#include "hw/recording/file_link.h"

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/options.h"
#include "hw/link/interruptible_wait.h"
#include "hw/probe/acquisition_plan.h"
#include "hw/recording/recording_reader.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {
namespace {

/// Of a longer gap in the stream the rest is left out.
constexpr DeviceDuration kLongestPause = std::chrono::seconds(10);
/// From one acquisition's last packet to the next one's first: whoever dates the last sticks by
/// the epoch does so meanwhile.
constexpr auto kBetweenAcquisitions = std::chrono::milliseconds(100);

/// `duration` is not negative.
DeviceTime saturated_sum(DeviceTime time, DeviceDuration duration) {
  return time > DeviceTime::max() - duration ? DeviceTime::max() : time + duration;
}

/// When each packet of a stream is due by the plan, on the host's clock.
class PlannedTimes {
 public:
  /// Takes the next packet. Throws UnreadableStream; std::runtime_error where no times are known.
  HostTime due(const Packet& packet);
  /// Moves all that follows.
  void delay(HostClock::duration by);
  /// Host time of device time 0; none before the first configuration.
  std::optional<HostTime> epoch() const {
    if (!begun_) return {};
    return last_due_ - (last_ - DeviceTime());
  }

 private:
  /// By the plan; none for a packet of which the plan does not say.
  std::optional<DeviceTime> time_of(const Packet& packet);

  StreamAudit audit_;
  bool begun_ = false;
  DeviceTime last_{};    ///< the latest time so far
  HostTime last_due_{};  ///< of that time
};

std::optional<DeviceTime> PlannedTimes::time_of(const Packet& packet) {
  if (const auto* stick = std::get_if<StickPacket>(&packet)) {
    const AuditResult result = audit_.take(stick->stick);
    if (result.accepted) audit_.deliver();
    if (result.contradicts || !begun_) return {};
    return audit_.configuration().value().plan.stick_time(stick->stick.sequence);
  }
  if (const auto* end = std::get_if<VolumeEndPacket>(&packet)) {
    if (audit_.take(*end).contradicts || !begun_) return {};
    return audit_.configuration().value().plan.volume_end_time(end->volume);
  }
  const auto& configuration = std::get<ConfigurationPacket>(packet);
  const AuditResult result = audit_.take(configuration);
  if (!configuration.knows_times) {
    throw std::runtime_error("the times of what follows are not known; pace must be asap");
  }
  if (result.contradicts) return {};
  const DeviceTime time = audit_.configuration().value().plan.stick_time(configuration.sequence);
  if (result.accepted) {
    last_due_ = begun_ ? last_due_ + kBetweenAcquisitions : HostClock::now();
    last_ = time;
    begun_ = true;
  }
  return time;
}

HostTime PlannedTimes::due(const Packet& packet) {
  const auto time = time_of(packet);
  if (time && *time > last_) {
    last_due_ += std::min(*time - last_, kLongestPause);
    last_ = *time;
  }
  return last_due_;
}

void PlannedTimes::delay(HostClock::duration by) {
  last_due_ += by;
}

}  // namespace

class FileLink::Impl {
 public:
  Impl(const std::filesystem::path& path, const FileLinkOptions& options);

  ReadResult read(std::span<std::byte> buffer, HostTime deadline);

  InterruptibleWait wait;
  bool resumed = false;  ///< since the last read
  std::string loss;      ///< empty: as Link::loss()
  SharedEpoch shared_epoch;

 private:
  /// Length of a loop's repetition, or of all turns so far.
  struct LoopLength {
    std::uint64_t sticks = 0;
    std::uint64_t volumes = 0;
  };
  struct Extent {
    std::uint64_t begin = 0;
    std::uint64_t end = std::numeric_limits<std::uint64_t>::max();
  };

  Extent find_acquisition(int number) const;
  std::uint64_t find_volume(std::uint32_t volume) const;
  void refuse_unknown_times() const;
  LoopLength measure_repetition();
  void skip_pause();
  ReadResult read_raw(std::span<std::byte> buffer);
  ReadResult read_packets(std::span<std::byte> buffer, HostTime deadline);
  bool take_packet();
  PacketStamp continued(const PacketStamp& stamp) const;
  void take_rest();
  void take_end();
  void share_epoch();

  const FileLinkOptions options_;
  const RecordingFile file_;
  std::uint64_t start_ = 0;     ///< file offset of the first packet
  std::uint64_t end_ = 0;       ///< file offset behind the last
  std::uint64_t offset_ = 0;    ///< file offset of the next raw byte
  std::uint64_t raw_left_ = 0;  ///< bytes of damage to copy before packet_
  LoopLength repetition_;
  LoopLength done_;                        ///< added to each stamp
  std::optional<AcquisitionPlan> plan_;    ///< in a loop
  std::optional<RecordingReader> reader_;  ///< none: the end was reached
  std::vector<std::byte> packet_;
  std::size_t delivered_ = 0;  ///< bytes of packet_
  HostTime packet_due_{};
  HostTime last_read_{};  ///< its end
  PlannedTimes times_;
};

FileLink::FileLink(const std::filesystem::path& path, const FileLinkOptions& options)
    : impl_(std::make_unique<Impl>(path, options)) {}

FileLink::~FileLink() = default;

ReadResult FileLink::read(std::span<std::byte> buffer, HostTime deadline) {
  return impl_->read(buffer, deadline);
}

void FileLink::cancel() {
  impl_->wait.cancel();
}

void FileLink::resume() {
  impl_->wait.resume();
  impl_->resumed = true;
}

void FileLink::close() {
  impl_->wait.close();
}

LinkCapabilities FileLink::capabilities() const {
  return {.origin = StreamOrigin::recording, .copy_in = true, .waits_for_reader = true};
}

std::optional<HostTime> FileLink::epoch() const {
  return impl_->shared_epoch.get();
}

std::string FileLink::loss() const {
  return impl_->loss.empty() ? Link::loss() : impl_->loss;
}

FileLink::Impl::Impl(const std::filesystem::path& path, const FileLinkOptions& options)
    : options_(options), file_(path) {
  check_options(options);
  const Extent extent = find_acquisition(options.acquisition);
  start_ = extent.begin;
  end_ = extent.end;
  if (options.start_volume > 0) {
    start_ = find_volume(static_cast<std::uint32_t>(options.start_volume));
  }
  if (options.pace == Pace::realtime) refuse_unknown_times();
  if (options.loop) repetition_ = measure_repetition();
  offset_ = start_;
  reader_.emplace(file_, start_, end_);
}

/// The first begins with the file, what comes before its configuration included.
FileLink::Impl::Extent FileLink::Impl::find_acquisition(int number) const {
  if (number == 0) return {};
  const RecordingContents contents = inspect_recording(file_.path());
  const auto index = static_cast<std::size_t>(number) - 1;
  if (index >= contents.acquisitions.size()) {
    throw InvalidOption("acquisition",
                        std::to_string(number),
                        file_.path().string() + " holds " +
                            std::to_string(contents.acquisition_count) + "; must be from 1 to " +
                            std::to_string(contents.acquisitions.size()));
  }
  Extent extent;
  if (index > 0) extent.begin = contents.acquisitions[index].offset;
  if (index + 1 < contents.acquisitions.size()) {
    extent.end = contents.acquisitions[index + 1].offset;
  }
  return extent;
}

std::uint64_t FileLink::Impl::find_volume(std::uint32_t volume) const {
  RecordingReader reader(file_, start_, end_);
  std::optional<std::uint32_t> last;
  std::string unreadable;
  try {
    while (const auto recorded = reader.next()) {
      if (!recorded->packet) continue;
      const auto* packet = std::get_if<ConfigurationPacket>(&*recorded->packet);
      if (packet == nullptr) continue;
      if (packet->volume == volume) return recorded->offset;
      last = packet->volume;
    }
  } catch (const UnreadableStream& error) {
    unreadable = "; from byte " + std::to_string(reader.offset()) + " on: " + error.what();
  }
  throw InvalidOption(
      "start_volume",
      std::to_string(volume),
      "no volume of " + file_.path().string() +
          (last ? ", whose last is " + std::to_string(*last) : ", which holds no configuration") +
          unreadable);
}

/// Of the first configuration: a later one without times ends the playback (PlannedTimes).
void FileLink::Impl::refuse_unknown_times() const {
  RecordingReader reader(file_, start_, end_);
  try {
    while (const auto recorded = reader.next()) {
      if (!recorded->packet) continue;
      const auto* packet = std::get_if<ConfigurationPacket>(&*recorded->packet);
      if (packet == nullptr) continue;
      if (packet->knows_times) return;
      throw InvalidOption("pace", "realtime", "must be asap; the times of this file are not known");
    }
  } catch (const UnreadableStream&) {
    // Nothing of it is played.
  }
}

FileLink::Impl::LoopLength FileLink::Impl::measure_repetition() {
  const auto refuse = [&](const std::string& why) {
    throw InvalidOption("loop", "true", file_.path().string() + " cannot be repeated: " + why);
  };
  RecordingReader reader(file_, start_, end_);
  StreamAudit audit;
  std::optional<ConfigurationPacket> first;
  std::uint32_t last = 0;
  const auto unreadable = for_each_packet(reader, [&](const RecordedPacket& recorded) {
    if (!recorded.packet) return;
    if (const auto* packet = std::get_if<ConfigurationPacket>(&*recorded.packet)) {
      const bool is_new = audit.take(*packet).accepted;
      if (is_new && first) refuse("it holds several acquisitions; choose one by acquisition=1");
      if (!first) first = *packet;
      last = std::max(last, packet->volume);
    } else if (const auto* stick = std::get_if<StickPacket>(&*recorded.packet)) {
      if (audit.take(stick->stick).accepted) audit.deliver();
      last = std::max(last, stick->stick.index.volume);
    }
  });
  if (unreadable) refuse(unreadable->reason);
  if (!first) refuse("it holds no configuration");
  plan_.emplace(first->probe, first->acquisition);
  LoopLength repetition;
  repetition.volumes = std::uint64_t{last} - std::min(last, first->volume) + 1;
  if (first->acquisition.motor == MotorMode::alternating && repetition.volumes % 2 != 0) {
    refuse("the motor alternates, and it holds an odd number of volumes");
  }
  repetition.sticks = static_cast<std::uint64_t>(plan_->sticks_per_volume()) * repetition.volumes;
  return repetition;
}

ReadResult FileLink::Impl::read(std::span<std::byte> buffer, HostTime deadline) {
  if (const auto interrupted = wait.interrupted()) return {0, *interrupted};
  try {
    if (options_.pace == Pace::asap && !options_.loop) return read_raw(buffer);
    skip_pause();
    const ReadResult result = read_packets(buffer, deadline);
    last_read_ = HostClock::now();
    return result;
  } catch (const std::exception& error) {
    loss = error.what();
    return {0, ReadStatus::lost};
  }
}

/// Stops the clock from the last read before cancel() to the first one after resume().
void FileLink::Impl::skip_pause() {
  if (!std::exchange(resumed, false) || !times_.epoch()) return;
  const auto pause = HostClock::now() - last_read_;
  times_.delay(pause);
  packet_due_ += pause;
  share_epoch();
}

ReadResult FileLink::Impl::read_raw(std::span<std::byte> buffer) {
  const auto most =
      static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), end_ - offset_));
  const std::size_t count = file_.read(offset_, buffer.first(most));
  offset_ += count;
  return {count, count > 0 ? ReadStatus::ok : ReadStatus::end_of_stream};
}

ReadResult FileLink::Impl::read_packets(std::span<std::byte> buffer, HostTime deadline) {
  while (raw_left_ == 0 && delivered_ == packet_.size()) {
    if (!take_packet()) return {0, ReadStatus::end_of_stream};
  }
  if (raw_left_ > 0) {
    const auto most = std::min<std::uint64_t>(buffer.size(), raw_left_);
    const ReadResult result = read_raw(buffer.first(static_cast<std::size_t>(most)));
    raw_left_ = result.status == ReadStatus::ok ? raw_left_ - result.bytes : 0;
    return result;
  }
  if (options_.pace == Pace::realtime && packet_due_ > HostClock::now()) {
    wait.sleep_until(std::min(packet_due_, deadline));
    if (const auto interrupted = wait.interrupted()) return {0, *interrupted};
    if (packet_due_ > HostClock::now()) return {0, ReadStatus::timeout};
  }
  const std::size_t count = std::min(buffer.size(), packet_.size() - delivered_);
  std::copy_n(packet_.begin() + static_cast<std::ptrdiff_t>(delivered_), count, buffer.begin());
  delivered_ += count;
  return {count, ReadStatus::ok};
}

/// Reads the next packet, and the extent of the damage before it. False at the end.
bool FileLink::Impl::take_packet() {
  if (!reader_) return false;
  delivered_ = 0;
  packet_.clear();
  std::optional<RecordedPacket> recorded;
  try {
    recorded = reader_->next();
  } catch (const UnreadableStream&) {
    take_rest();
    return true;
  }
  if (!recorded) {
    take_end();
    return true;
  }
  raw_left_ = recorded->damage_before;
  offset_ = recorded->offset - raw_left_;
  packet_.assign(recorded->bytes.begin(), recorded->bytes.end());
  if (options_.loop) restamp(packet_, continued(packet_stamp(packet_)));
  if (options_.pace == Pace::asap || !is_known_kind(packet_)) return true;
  const auto packet = options_.loop ? parse_packet(packet_) : std::move(recorded->packet);
  if (!packet) return true;
  try {
    packet_due_ = times_.due(*packet);
  } catch (const UnreadableStream&) {
    // The reader of the link ends there.
  }
  share_epoch();
  return true;
}

/// The stamp in the current repetition of a loop. Throws std::runtime_error where a number ends.
PacketStamp FileLink::Impl::continued(const PacketStamp& stamp) const {
  const bool has_volume = done_.volumes <= std::numeric_limits<std::uint32_t>::max() - stamp.volume;
  if (!has_volume || done_.sticks > std::numeric_limits<std::uint64_t>::max() - stamp.sequence) {
    throw std::runtime_error("the loop has come to the last number of a volume");
  }
  return {stamp.sequence + done_.sticks,
          static_cast<std::uint32_t>(stamp.volume + done_.volumes),
          // Computed from the start each time, so that rounding does not accumulate.
          saturated_sum(stamp.time, plan_->stick_time(done_.sticks).time_since_epoch())};
}

/// Leaves the packets from an unreadable one on to the reader, as they are.
void FileLink::Impl::take_rest() {
  offset_ = reader_->end();
  raw_left_ = std::min(file_.bytes(), end_) - offset_;
  reader_.reset();
}

/// Reads the extent of the damage at the end, and starts the next repetition of a loop.
void FileLink::Impl::take_end() {
  raw_left_ = reader_->damage_at_end();
  offset_ = std::min(file_.bytes(), end_) - raw_left_;
  reader_.reset();
  if (!options_.loop) return;
  done_.sticks += repetition_.sticks;
  done_.volumes += repetition_.volumes;
  reader_.emplace(file_, start_, end_);
}

void FileLink::Impl::share_epoch() {
  if (const auto epoch = times_.epoch()) shared_epoch.set(*epoch);
}

}  // namespace wobblebench::hw
