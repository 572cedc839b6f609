// Wire format, version 1: what comes over a link, and what a recording holds.
// docs/wire_format.md is the specification; firmware is written from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/clock.h"
#include "hw/probe/stick.h"
#include "hw/wire/stream_origin.h"

namespace wobblebench::hw {

inline constexpr std::array<std::byte, 4> kWireMagic = {
    std::byte{'W'}, std::byte{'B'}, std::byte{'S'}, std::byte{'T'}};
inline constexpr std::uint16_t kWireVersion = 1;
inline constexpr std::size_t kWireHeaderBytes = 64;
/// No packet of any version has a longer payload; a length beyond it is damage.
inline constexpr std::size_t kWireMaxPayloadBytes = 65536;
inline constexpr std::size_t kWireConfigurationBytes = 160;
inline constexpr std::size_t kWireMaxSamples = 4096;

enum class PacketKind : std::uint16_t { configuration = 1, stick = 2, volume_end = 3 };

/// Bits of the header's flags; all others are zero.
inline constexpr std::uint32_t kFlagCrcUnchecked = 1;
inline constexpr std::uint32_t kFlagLinearEnvelope = 2;

/// The acquisition that the sticks that follow belong to. At the start of every volume.
struct ConfigurationPacket {
  std::uint64_t sequence = 0;  ///< of the stick that comes next
  std::uint32_t volume = 0;    ///< of the stick that comes next
  DeviceTime time{};
  StreamOrigin source = StreamOrigin::simulated;  ///< what made the samples, also in a recording
  ProbeOptions probe;
  AcquisitionOptions acquisition;
};

struct StickPacket {
  Stick stick;
};

struct VolumeEndPacket {
  std::uint64_t sequence = 0;  ///< of the stick that comes next
  std::uint32_t volume = 0;    ///< that ends
  DeviceTime time{};           ///< when its last stick was complete
};

using Packet = std::variant<ConfigurationPacket, StickPacket, VolumeEndPacket>;

/// `none` leaves the CRC out, for sources that cannot compute it; the packet says so.
enum class WireCrc { crc32c, none };

/// Each appends one packet to `out`. A configuration always has its CRC: it is where a receiver
/// that lost its step finds it again. The samples of a stick are written bit for bit, NaN included;
/// throws std::length_error unless there are 1 to 4096 of them.
void encode(const ConfigurationPacket& packet, std::vector<std::byte>& out);
void encode(const Stick& stick, std::vector<std::byte>& out, WireCrc crc = WireCrc::crc32c);
void encode(const VolumeEndPacket& packet,
            std::vector<std::byte>& out,
            WireCrc crc = WireCrc::crc32c);

/// The stream is of a version that this program cannot read.
class UnsupportedWireVersion : public std::runtime_error {
 public:
  explicit UnsupportedWireVersion(std::uint16_t version)
      : std::runtime_error("wire format version " + std::to_string(version) +
                           ": this program reads version " + std::to_string(kWireVersion)),
        version_(version) {}
  std::uint16_t version() const { return version_; }

 private:
  std::uint16_t version_;
};

/// What a decoder had to pass over.
struct WireDamage {
  std::uint64_t places = 0;         ///< places in the stream where decoding lost its step
  std::uint64_t bytes_skipped = 0;  ///< bytes that belong to no accepted packet
};

}  // namespace wobblebench::hw
