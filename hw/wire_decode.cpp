#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "hw/wire.h"
#include "hw/wire_layout.h"

namespace wobblebench::hw {

using namespace wire_layout;

namespace {

bool known_kind(std::uint16_t kind) {
  return kind >= static_cast<std::uint16_t>(PacketKind::configuration) &&
         kind <= static_cast<std::uint16_t>(PacketKind::volume_end);
}

/// The one length and the flags that a packet of a known kind can have.
bool sound_shape(Bytes header, PacketKind kind, std::size_t payload_bytes) {
  const auto samples = get<std::uint32_t>(header, kSamplesAt);
  const auto flags = get<std::uint32_t>(header, kFlagsAt);
  switch (kind) {
    case PacketKind::configuration:
      return payload_bytes == kWireConfigurationBytes && samples == 0 && flags == 0;
    case PacketKind::stick:
      return samples >= 1 && samples <= kWireMaxSamples &&
             payload_bytes == stick_payload_bytes(samples) &&
             (flags & ~(kFlagCrcUnchecked | kFlagLinearEnvelope)) == 0;
    case PacketKind::volume_end:
      return payload_bytes == 0 && samples == 0 && (flags & ~kFlagCrcUnchecked) == 0;
  }
  return false;
}

/// Bytes of the packet that this header begins, or 0 if it cannot be a header.
std::size_t packet_bytes(Bytes header) {
  if (!std::equal(kWireMagic.begin(), kWireMagic.end(), header.begin())) return 0;
  const auto version = get<std::uint16_t>(header, kVersionAt);
  const auto kind = get<std::uint16_t>(header, kKindAt);
  const auto payload_bytes = get<std::uint32_t>(header, kPayloadBytesAt);
  if (version < kWireVersion || payload_bytes > kWireMaxPayloadBytes || payload_bytes % 8 != 0) {
    return 0;
  }
  if (version == kWireVersion && known_kind(kind) &&
      !sound_shape(header, static_cast<PacketKind>(kind), payload_bytes)) {
    return 0;
  }
  return kWireHeaderBytes + payload_bytes;
}

/// Only a known kind may go unchecked, and only where a packet has to begin; its CRC field is 0, so
/// that one damaged flag does not turn checking off.
bool unchecked(Bytes packet, bool in_step) {
  const bool may_be = get<std::uint16_t>(packet, kVersionAt) == kWireVersion &&
                      known_kind(get<std::uint16_t>(packet, kKindAt));
  return in_step && may_be && (get<std::uint32_t>(packet, kFlagsAt) & kFlagCrcUnchecked) != 0 &&
         get<std::uint32_t>(packet, kCrcAt) == 0;
}

bool sound_crc(Bytes packet) {
  const bool says_unchecked = get<std::uint16_t>(packet, kVersionAt) == kWireVersion &&
                              (get<std::uint32_t>(packet, kFlagsAt) & kFlagCrcUnchecked) != 0;
  return !says_unchecked && get<std::uint32_t>(packet, kCrcAt) == packet_crc(packet);
}

DeviceTime packet_time(Bytes packet) {
  return DeviceTime(DeviceDuration(get<std::int64_t>(packet, kTimeAt)));
}

std::optional<Packet> parse_configuration(Bytes packet) {
  const Bytes payload = packet.subspan(kWireHeaderBytes);
  const auto motor = get<std::uint32_t>(payload, kMotorModeAt);
  const auto source = get<std::uint32_t>(payload, kSourceAt);
  if (motor > static_cast<std::uint32_t>(MotorMode::fly_back)) return {};
  if (source < static_cast<std::uint32_t>(Provenance::simulated) ||
      source > static_cast<std::uint32_t>(Provenance::hardware)) {
    return {};
  }
  ConfigurationPacket parsed;
  parsed.sequence = get<std::uint64_t>(packet, kSequenceAt);
  parsed.volume = get<std::uint32_t>(packet, kVolumeAt);
  parsed.time = packet_time(packet);
  parsed.source = static_cast<Provenance>(source);
  parsed.acquisition.motor = static_cast<MotorMode>(motor);
  visit_configuration(parsed, [&](std::size_t offset, auto& value) {
    value = get<std::remove_reference_t<decltype(value)>>(payload, offset);
  });
  return parsed;
}

std::optional<Packet> parse_stick(Bytes packet) {
  Stick stick;
  stick.sequence = get<std::uint64_t>(packet, kSequenceAt);
  stick.index = {get<std::uint32_t>(packet, kVolumeAt),
                 get<std::uint32_t>(packet, kFrameAt),
                 get<std::uint32_t>(packet, kLineAt)};
  stick.time = packet_time(packet);
  stick.motor_angle_rad = get<double>(packet, kMotorAngleAt);
  stick.sweep_direction = get<std::int32_t>(packet, kSweepDirectionAt);
  if (!std::isfinite(stick.motor_angle_rad)) return {};
  if (stick.sweep_direction != 1 && stick.sweep_direction != -1) return {};
  const bool linear = (get<std::uint32_t>(packet, kFlagsAt) & kFlagLinearEnvelope) != 0;
  stick.scale = linear ? SampleScale::linear_envelope : SampleScale::log_compressed;
  stick.samples.resize(get<std::uint32_t>(packet, kSamplesAt));
  for (std::size_t i = 0; i < stick.samples.size(); ++i) {
    stick.samples[i] = get<float>(packet, kWireHeaderBytes + 4 * i);
  }
  return StickPacket{std::move(stick)};
}

std::optional<Packet> parse_volume_end(Bytes packet) {
  return VolumeEndPacket{get<std::uint64_t>(packet, kSequenceAt),
                         get<std::uint32_t>(packet, kVolumeAt),
                         packet_time(packet)};
}

/// None if a field has a value that the format does not know.
std::optional<Packet> parse(Bytes packet) {
  switch (static_cast<PacketKind>(get<std::uint16_t>(packet, kKindAt))) {
    case PacketKind::configuration:
      return parse_configuration(packet);
    case PacketKind::stick:
      return parse_stick(packet);
    case PacketKind::volume_end:
      return parse_volume_end(packet);
  }
  return {};
}

}  // namespace

void Decoder::feed(std::span<const std::byte> bytes) {
  buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(read_));
  read_ = 0;
  finished_ = false;
  buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
}

std::optional<std::size_t> Decoder::sound_packet() const {
  const Bytes bytes = pending();
  if (bytes.size() < kWireHeaderBytes) return {};
  const std::size_t size = packet_bytes(bytes.first(kWireHeaderBytes));
  if (size > bytes.size()) return {};
  if (size == 0) return 0;
  const Bytes packet = bytes.first(size);
  return unchecked(packet, in_step_) || sound_crc(packet) ? size : 0;
}

void Decoder::skip(std::size_t bytes) {
  if (in_step_) ++damage_.places;
  in_step_ = false;
  damage_.bytes_skipped += bytes;
  read_ += bytes;
}

void Decoder::skip_to_magic() {
  const Bytes rest = pending().subspan(1);
  const auto found = std::search(rest.begin(), rest.end(), kWireMagic.begin(), kWireMagic.end());
  const auto clear = static_cast<std::size_t>(found - rest.begin());
  // A magic may begin in the last bytes and end in what is still to come.
  const bool none = found == rest.end() && !finished_;
  skip(1 + (none ? clear - std::min(clear, kWireMagic.size() - 1) : clear));
}

std::optional<Packet> Decoder::next() {
  while (pending_bytes() > 0) {
    const std::optional<std::size_t> size = sound_packet();
    if (!size && !finished_) return {};
    if (!size || *size == 0) {
      skip_to_magic();
      continue;
    }
    const Bytes packet = pending().first(*size);
    const auto version = get<std::uint16_t>(packet, kVersionAt);
    if (version != kWireVersion) throw UnsupportedWireVersion(version);
    const bool later_kind = !known_kind(get<std::uint16_t>(packet, kKindAt));
    std::optional<Packet> parsed = later_kind ? std::nullopt : parse(packet);
    if (!parsed && !later_kind) {
      skip(*size);
      continue;
    }
    read_ += *size;
    in_step_ = true;
    if (parsed) return parsed;
  }
  return {};
}

}  // namespace wobblebench::hw
