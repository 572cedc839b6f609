#include "hw/wire/decoder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "hw/wire/layout.h"

namespace wobblebench::hw {

using namespace wire_layout;

namespace {

bool known_kind(std::uint16_t kind) {
  return kind >= static_cast<std::uint16_t>(PacketKind::configuration) &&
         kind <= static_cast<std::uint16_t>(PacketKind::volume_end);
}

/// Checks payload length, sample count and flags of a known kind.
bool valid_shape(Bytes header, PacketKind kind, std::size_t payload_bytes) {
  const auto samples = get<std::uint32_t>(header, kSamplesOffset);
  const auto flags = get<std::uint32_t>(header, kFlagsOffset);
  switch (kind) {
    case PacketKind::configuration:
      return (payload_bytes == kWireConfigurationBytes ||
              payload_bytes == kWireConfigurationBytesWithoutScale) &&
             samples == 0 && (flags & ~(kFlagTimesNotKnown | kFlagRangeAlone)) == 0;
    case PacketKind::stick:
      return samples >= 1 && samples <= kWireMaxSamples &&
             payload_bytes == stick_payload_bytes(samples) &&
             (flags & ~(kFlagCrcUnchecked | kFlagLinearEnvelope)) == 0;
    case PacketKind::volume_end:
      return payload_bytes == 0 && samples == 0 && (flags & ~kFlagCrcUnchecked) == 0;
  }
  return false;
}

/// Size of the packet that starts with this header, bytes; 0 if it is not a header.
std::size_t packet_bytes(Bytes header) {
  if (!std::equal(kWireMagic.begin(), kWireMagic.end(), header.begin())) return 0;
  const auto version = get<std::uint16_t>(header, kVersionOffset);
  const auto kind = get<std::uint16_t>(header, kKindOffset);
  const auto payload_bytes = get<std::uint32_t>(header, kPayloadBytesOffset);
  if (version < kWireVersion || payload_bytes > kWireMaxPayloadBytes || payload_bytes % 8 != 0) {
    return 0;
  }
  if (version == kWireVersion && known_kind(kind) &&
      !valid_shape(header, static_cast<PacketKind>(kind), payload_bytes)) {
    return 0;
  }
  return kWireHeaderBytes + payload_bytes;
}

/// Only a known kind may lack a CRC, and only where the stream is in sync; its CRC field is 0, so
/// that one damaged flag does not turn checking off.
bool accepted_unchecked(Bytes packet, bool in_sync) {
  const bool may_be = get<std::uint16_t>(packet, kVersionOffset) == kWireVersion &&
                      known_kind(get<std::uint16_t>(packet, kKindOffset));
  return in_sync && may_be && (get<std::uint32_t>(packet, kFlagsOffset) & kFlagCrcUnchecked) != 0 &&
         get<std::uint32_t>(packet, kCrcOffset) == 0;
}

bool has_correct_crc(Bytes packet) {
  const bool has_none = get<std::uint16_t>(packet, kVersionOffset) == kWireVersion &&
                        (get<std::uint32_t>(packet, kFlagsOffset) & kFlagCrcUnchecked) != 0;
  return !has_none && get<std::uint32_t>(packet, kCrcOffset) == packet_crc(packet);
}

std::size_t bytes_before_magic(Bytes bytes) {
  const std::byte* const end = bytes.data() + bytes.size();
  for (const std::byte* at = bytes.data(); end - at >= std::ptrdiff_t{kWireMagic.size()}; ++at) {
    const auto left = static_cast<std::size_t>(end - at);
    at = static_cast<const std::byte*>(std::memchr(at, std::to_integer<int>(kWireMagic[0]), left));
    if (at == nullptr || end - at < std::ptrdiff_t{kWireMagic.size()}) break;
    if (std::equal(kWireMagic.begin(), kWireMagic.end(), at)) {
      return static_cast<std::size_t>(at - bytes.data());
    }
  }
  return bytes.size();
}

std::optional<Packet> parse_configuration(Bytes packet) {
  const Bytes payload = packet.subspan(kWireHeaderBytes);
  const auto motor = get<std::uint32_t>(payload, kMotorModeOffset);
  const auto source = get<std::uint32_t>(payload, kSourceOffset);
  if (motor > static_cast<std::uint32_t>(MotorMode::fly_back)) return {};
  if (source < static_cast<std::uint32_t>(StreamOrigin::simulated) ||
      source > static_cast<std::uint32_t>(StreamOrigin::hardware)) {
    return {};
  }
  ConfigurationPacket parsed;
  const PacketStamp stamp = packet_stamp(packet);
  parsed.sequence = stamp.sequence;
  parsed.volume = stamp.volume;
  parsed.time = stamp.time;
  parsed.source = static_cast<StreamOrigin>(source);
  parsed.acquisition.motor = static_cast<MotorMode>(motor);
  visit_configuration(parsed, [&](std::size_t offset, auto& value) {
    if (offset >= payload.size()) return;  // from before the display scale
    value = get<std::remove_reference_t<decltype(value)>>(payload, offset);
  });
  const auto flags = get<std::uint32_t>(packet, kFlagsOffset);
  parsed.knows_times = (flags & kFlagTimesNotKnown) == 0;
  parsed.display_scale.range_alone = (flags & kFlagRangeAlone) != 0;
  return parsed;
}

std::optional<Packet> parse_stick(Bytes packet) {
  Stick stick;
  const PacketStamp stamp = packet_stamp(packet);
  stick.sequence = stamp.sequence;
  stick.index = {stamp.volume,
                 get<std::uint32_t>(packet, kFrameOffset),
                 get<std::uint32_t>(packet, kLineOffset)};
  stick.time = stamp.time;
  stick.motor_angle_rad = get<double>(packet, kMotorAngleOffset);
  stick.sweep_direction = get<std::int32_t>(packet, kSweepDirectionOffset);
  // The following stick needs a number, too.
  if (stick.sequence == std::numeric_limits<std::uint64_t>::max()) return {};
  if (!std::isfinite(stick.motor_angle_rad)) return {};
  if (stick.sweep_direction != 1 && stick.sweep_direction != -1) return {};
  const bool linear = (get<std::uint32_t>(packet, kFlagsOffset) & kFlagLinearEnvelope) != 0;
  stick.scale = linear ? SampleScale::linear_envelope : SampleScale::log_compressed;
  stick.checked = (get<std::uint32_t>(packet, kFlagsOffset) & kFlagCrcUnchecked) == 0;
  stick.samples.resize(get<std::uint32_t>(packet, kSamplesOffset));
  get_floats(packet.subspan(kWireHeaderBytes), stick.samples);
  return StickPacket{std::move(stick)};
}

std::optional<Packet> parse_volume_end(Bytes packet) {
  const PacketStamp stamp = packet_stamp(packet);
  return VolumeEndPacket{stamp.sequence, stamp.volume, stamp.time};
}

}  // namespace

std::uint16_t packet_version(Bytes packet) {
  return get<std::uint16_t>(packet, kVersionOffset);
}

bool is_known_kind(Bytes packet) {
  return known_kind(get<std::uint16_t>(packet, kKindOffset));
}

PacketKind packet_kind(Bytes packet) {
  return static_cast<PacketKind>(get<std::uint16_t>(packet, kKindOffset));
}

PacketStamp packet_stamp(Bytes packet) {
  return {get<std::uint64_t>(packet, kSequenceOffset),
          get<std::uint32_t>(packet, kVolumeOffset),
          DeviceTime(DeviceDuration(get<std::int64_t>(packet, kTimeOffset)))};
}

void restamp(std::span<std::byte> packet, const PacketStamp& stamp) {
  put(packet.data() + kSequenceOffset, stamp.sequence);
  put(packet.data() + kVolumeOffset, stamp.volume);
  put(packet.data() + kTimeOffset,
      static_cast<std::int64_t>(stamp.time.time_since_epoch().count()));
  if ((get<std::uint32_t>(packet, kFlagsOffset) & kFlagCrcUnchecked) != 0) return;
  put(packet.data() + kCrcOffset, packet_crc(packet));
}

void PacketFramer::feed(Bytes bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(read_));
  read_ = 0;
  finished_ = false;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<std::size_t> PacketFramer::front_packet_bytes() {
  const Bytes bytes = pending();
  if (bytes.size() < kWireHeaderBytes) return {};
  const std::size_t size = packet_bytes(bytes.first(kWireHeaderBytes));
  if (size > bytes.size()) return {};
  if (size == 0) return 0;
  const Bytes packet = bytes.first(size);
  if (accepted_unchecked(packet, in_sync_) || has_correct_crc(packet)) return size;
  ++wrong_checksums_;
  return 0;
}

void PacketFramer::note_damage(std::size_t bytes) {
  if (in_sync_) {
    ++damage_.regions;
    skipped_ = 0;
  }
  in_sync_ = false;
  skipped_ += bytes;
  damage_.bytes_skipped += bytes;
}

void PacketFramer::skip_to_magic() {
  const Bytes rest = pending().subspan(1);
  const std::size_t clear = bytes_before_magic(rest);
  // The last bytes may be the start of a magic that continues in the next feed().
  const bool none = clear == rest.size() && !finished_;
  const std::size_t bytes = 1 + (none ? clear - std::min(clear, kWireMagic.size() - 1) : clear);
  note_damage(bytes);
  read_ += bytes;
  consumed_ += bytes;
}

std::optional<PacketFrame> PacketFramer::next() {
  while (pending_bytes() > 0) {
    const std::optional<std::size_t> size = front_packet_bytes();
    if (!size && !finished_) return {};
    if (!size || *size == 0) {
      skip_to_magic();
      continue;
    }
    const PacketFrame frame{pending().first(*size), consumed_};
    read_ += *size;
    consumed_ += *size;
    last_bytes_ = *size;
    was_in_sync_ = in_sync_;
    in_sync_ = true;
    return frame;
  }
  return {};
}

void PacketFramer::reject_last() {
  in_sync_ = was_in_sync_;
  note_damage(last_bytes_);
}

using namespace wire_layout;

std::optional<Packet> parse_packet(Bytes packet) {
  switch (packet_kind(packet)) {
    case PacketKind::configuration:
      return parse_configuration(packet);
    case PacketKind::stick:
      return parse_stick(packet);
    case PacketKind::volume_end:
      return parse_volume_end(packet);
  }
  return {};
}

std::optional<Packet> Decoder::next() {
  while (!later_version_) {
    const auto frame = framer_.next();
    if (!frame) return {};
    if (packet_version(frame->bytes) != kWireVersion) {
      later_version_ = packet_version(frame->bytes);
      break;
    }
    // Of a later revision; takes no sequence number.
    if (!is_known_kind(frame->bytes)) continue;
    if (auto parsed = parse_packet(frame->bytes)) return parsed;
    framer_.reject_last();
  }
  throw UnsupportedWireVersion(*later_version_);
}

}  // namespace wobblebench::hw
