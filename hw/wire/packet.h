// Packets of the wire format, version 1, as sent over a link and stored in a recording.
// Specification: docs/wire_format.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/clock.h"
#include "hw/probe/polar_volume.h"
#include "hw/wire/configuration.h"
#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {

inline constexpr std::array<std::byte, 4> kWireMagic = {
    std::byte{'W'}, std::byte{'B'}, std::byte{'S'}, std::byte{'T'}};
inline constexpr std::size_t kWireHeaderBytes = 64;
/// No packet of any version has a longer payload; a length beyond it is damage.
inline constexpr std::size_t kWireMaxPayloadBytes = 65536;
inline constexpr std::size_t kWireConfigurationBytes = 184;
/// Of configurations from before they had a display scale.
inline constexpr std::size_t kWireConfigurationBytesWithoutScale = 160;
inline constexpr std::size_t kWireMaxSamples = 4096;

enum class PacketKind : std::uint16_t { configuration = 1, stick = 2, volume_end = 3 };

/// Bits of the header's flags; all others are zero.
inline constexpr std::uint32_t kFlagCrcUnchecked = 1;
inline constexpr std::uint32_t kFlagLinearEnvelope = 2;
inline constexpr std::uint32_t kFlagTimesNotKnown = 4;  ///< Configuration::knows_times
inline constexpr std::uint32_t kFlagRangeAlone = 8;     ///< DisplayScale::range_alone

/// The acquisition of the sticks that follow. At the start of every volume.
struct ConfigurationPacket {
  std::uint64_t sequence = 0;  ///< of the next stick
  std::uint32_t volume = 0;    ///< of the next stick
  DeviceTime time{};
  StreamOrigin source = StreamOrigin::simulated;  ///< of the samples, also in a recording
  ProbeOptions probe;
  AcquisitionOptions acquisition;
  SubjectHash subject = {};
  DisplayScale display_scale = {};
  bool knows_times = true;
};

struct StickPacket {
  Stick stick;
};

struct VolumeEndPacket {
  std::uint64_t sequence = 0;  ///< of the next stick
  std::uint32_t volume = 0;    ///< the one that ends
  DeviceTime time{};           ///< end of its last stick
};

using Packet = std::variant<ConfigurationPacket, StickPacket, VolumeEndPacket>;

/// `none`: for sources that cannot compute a CRC; marked by a flag of the packet.
enum class WireCrc { crc32c, none };

/// Each appends one packet to `out`. A configuration always has its CRC: a receiver resynchronises
/// on it. The samples of a stick are written bit for bit, NaN included; throws std::length_error
/// unless there are 1 to 4096 of them.
void encode(const ConfigurationPacket& packet, std::vector<std::byte>& out);
void encode(const Stick& stick, std::vector<std::byte>& out, WireCrc crc = WireCrc::crc32c);
void encode(const VolumeEndPacket& packet,
            std::vector<std::byte>& out,
            WireCrc crc = WireCrc::crc32c);

}  // namespace wobblebench::hw
