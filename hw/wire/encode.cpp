#include <algorithm>
#include <stdexcept>
#include <string>

#include "hw/wire/layout.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

using namespace wire_layout;

namespace {

/// Appends a packet with zero fields after the payload length, and returns its first byte.
std::byte* append_packet(std::vector<std::byte>& out, PacketKind kind, std::size_t payload_bytes) {
  const std::size_t start = out.size();
  out.resize(start + kWireHeaderBytes + payload_bytes);
  std::byte* packet = out.data() + start;
  std::copy(kWireMagic.begin(), kWireMagic.end(), packet);
  put(packet + kVersionOffset, kWireVersion);
  put(packet + kKindOffset, static_cast<std::uint16_t>(kind));
  put(packet + kPayloadBytesOffset, static_cast<std::uint32_t>(payload_bytes));
  return packet;
}

/// Writes flags and CRC.
void seal(std::byte* packet, std::size_t payload_bytes, std::uint32_t flags, WireCrc crc) {
  if (crc == WireCrc::none) flags |= kFlagCrcUnchecked;
  put(packet + kFlagsOffset, flags);
  if (crc == WireCrc::none) return;
  put(packet + kCrcOffset, packet_crc({packet, kWireHeaderBytes + payload_bytes}));
}

}  // namespace

void encode(const ConfigurationPacket& packet, std::vector<std::byte>& out) {
  std::byte* header = append_packet(out, PacketKind::configuration, kWireConfigurationBytes);
  put(header + kSequenceOffset, packet.sequence);
  put(header + kVolumeOffset, packet.volume);
  put(header + kTimeOffset, static_cast<std::int64_t>(packet.time.time_since_epoch().count()));
  std::byte* payload = header + kWireHeaderBytes;
  ConfigurationPacket copy = packet;
  copy.acquisition = with_one_zone(packet.acquisition);
  visit_configuration(copy, [&](std::size_t offset, auto& value) { put(payload + offset, value); });
  put(payload + kMotorModeOffset, static_cast<std::uint32_t>(packet.acquisition.motor));
  put(payload + kSourceOffset, static_cast<std::uint32_t>(packet.source));
  const std::uint32_t flags = (packet.knows_times ? 0 : kFlagTimesNotKnown) |
                              (packet.display_scale.range_alone ? kFlagRangeAlone : 0);
  seal(header, kWireConfigurationBytes, flags, WireCrc::crc32c);
}

void encode(const Stick& stick, std::vector<std::byte>& out, WireCrc crc) {
  const std::size_t samples = stick.samples.size();
  if (samples < 1 || samples > kWireMaxSamples) {
    throw std::length_error("a stick of " + std::to_string(samples) + " samples: must be 1 to " +
                            std::to_string(kWireMaxSamples));
  }
  const std::size_t payload_bytes = stick_payload_bytes(samples);
  std::byte* header = append_packet(out, PacketKind::stick, payload_bytes);
  put(header + kSequenceOffset, stick.sequence);
  put(header + kVolumeOffset, stick.index.volume);
  put(header + kFrameOffset, stick.index.frame);
  put(header + kLineOffset, stick.index.line);
  put(header + kSweepDirectionOffset, static_cast<std::int32_t>(stick.sweep_direction));
  put(header + kTimeOffset, static_cast<std::int64_t>(stick.time.time_since_epoch().count()));
  put(header + kMotorAngleOffset, stick.motor_angle_rad);
  put(header + kSamplesOffset, static_cast<std::uint32_t>(samples));
  std::byte* payload = header + kWireHeaderBytes;
  for (std::size_t i = 0; i < samples; ++i) put(payload + 4 * i, stick.samples[i]);
  const bool linear = stick.scale == SampleScale::linear_envelope;
  seal(header, payload_bytes, linear ? kFlagLinearEnvelope : 0, crc);
}

void encode(const VolumeEndPacket& packet, std::vector<std::byte>& out, WireCrc crc) {
  std::byte* header = append_packet(out, PacketKind::volume_end, 0);
  put(header + kSequenceOffset, packet.sequence);
  put(header + kVolumeOffset, packet.volume);
  put(header + kTimeOffset, static_cast<std::int64_t>(packet.time.time_since_epoch().count()));
  seal(header, 0, 0, crc);
}

}  // namespace wobblebench::hw
