#include "hw/wire/packet_frame.h"

#include <algorithm>
#include <cstring>

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
             samples == 0 && flags == 0;
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

std::optional<std::size_t> PacketFramer::front_packet_bytes() const {
  const Bytes bytes = pending();
  if (bytes.size() < kWireHeaderBytes) return {};
  const std::size_t size = packet_bytes(bytes.first(kWireHeaderBytes));
  if (size > bytes.size()) return {};
  if (size == 0) return 0;
  const Bytes packet = bytes.first(size);
  return accepted_unchecked(packet, in_sync_) || has_correct_crc(packet) ? size : 0;
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

}  // namespace wobblebench::hw
