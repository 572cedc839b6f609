// Field offsets and number formats of packets, shared by encoder and decoder. Specification:
// docs/wire_format.md.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "base/unsigned_of.h"
#include "hw/wire/crc32c.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw::wire_layout {

// In the header, bytes.
inline constexpr std::size_t kVersionOffset = 4;
inline constexpr std::size_t kKindOffset = 6;
inline constexpr std::size_t kPayloadBytesOffset = 8;
inline constexpr std::size_t kFlagsOffset = 12;
inline constexpr std::size_t kSequenceOffset = 16;
inline constexpr std::size_t kVolumeOffset = 24;
inline constexpr std::size_t kFrameOffset = 28;
inline constexpr std::size_t kLineOffset = 32;
inline constexpr std::size_t kSweepDirectionOffset = 36;
inline constexpr std::size_t kTimeOffset = 40;
inline constexpr std::size_t kMotorAngleOffset = 48;
inline constexpr std::size_t kSamplesOffset = 56;
inline constexpr std::size_t kCrcOffset = 60;

using Bytes = std::span<const std::byte>;

/// Little-endian on every machine, at any alignment.
template <class T>
void put(std::byte* to, T value) {
  const auto bits = std::bit_cast<typename UnsignedOf<sizeof(T)>::type>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) to[i] = static_cast<std::byte>(bits >> (8 * i));
}

template <class T>
T get(Bytes from, std::size_t offset) {
  using Bits = typename UnsignedOf<sizeof(T)>::type;
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bits = static_cast<Bits>(bits | static_cast<Bits>(from[offset + i]) << (8 * i));
  }
  return std::bit_cast<T>(bits);
}

/// Reads values.size() floats, bit for bit, NaN included.
inline void get_floats(Bytes from, std::span<float> values) {
  if constexpr (std::endian::native == std::endian::little) {
    std::memcpy(values.data(), from.data(), values.size_bytes());
  } else {
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = get<float>(from, 4 * i);
  }
}

inline std::size_t stick_payload_bytes(std::size_t samples) {
  return (samples * 4 + 7) / 8 * 8;
}

inline std::uint32_t packet_crc(Bytes packet) {
  return crc32c(packet.subspan(kWireHeaderBytes), crc32c(packet.first(kCrcOffset)));
}

/// Calls field(offset in the payload, value) for each number of a configuration's payload.
template <class Field>
void visit_configuration(ConfigurationPacket& packet, Field&& field) {
  ProbeOptions& probe = packet.probe;
  AcquisitionOptions& plan = packet.acquisition;
  field(0, probe.radius_m);
  field(8, probe.wobble_radius_m);
  field(16, probe.center_frequency_hz);
  field(24, probe.fractional_bandwidth);
  field(32, probe.f_number);
  field(40, probe.transmit_focus_m);
  field(48, probe.pitch_m);
  field(56, probe.element_height_m);
  field(64, probe.elevation_focus_m);
  field(72, plan.depth_m);
  field(80, plan.sector_rad);
  field(88, plan.fan_rad);
  field(96, plan.sound_speed_m_s);
  field(104, plan.dead_time_s);
  field(112, plan.fly_back_s);
  field(120, probe.elements);
  field(124, plan.sticks_per_frame);
  field(128, plan.samples_per_stick);
  field(132, plan.frames_per_volume);
  field(136, plan.volumes);
  field(148, packet.subject.phantom);
  field(152, packet.subject.placement);
  field(156, packet.subject.motion);
  field(160, packet.display_scale.full_scale_db);
  field(168, packet.display_scale.dynamic_range_db);
  field(176, packet.display_scale.tgc_db_per_cm_mhz);
}
// In a configuration's payload, bytes.
inline constexpr std::size_t kMotorModeOffset = 140;
inline constexpr std::size_t kSourceOffset = 144;

}  // namespace wobblebench::hw::wire_layout
