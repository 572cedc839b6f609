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

#include "hw/acquisition_plan.h"
#include "hw/clock.h"
#include "hw/provenance.h"
#include "hw/stick.h"

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
  Provenance source = Provenance::simulated;  ///< what made the samples, also in a recording
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

/// Incremental parser: bytes in, in pieces of any size; packets out. After damage it searches for
/// the next packet: magic, a sound header and a right CRC. Not thread-safe.
class Decoder {
 public:
  void feed(std::span<const std::byte> bytes);

  /// No more bytes will come for now: what looks like the beginning of a long packet is damage.
  void finish() { finished_ = true; }

  /// The next packet, or none until more bytes are fed. Throws UnsupportedWireVersion, at every
  /// call from then on, where a packet with a right CRC has a later version.
  std::optional<Packet> next();

  const WireDamage& damage() const { return damage_; }
  /// Bytes fed that are neither decoded nor skipped yet.
  std::size_t pending_bytes() const { return buffer_.size() - read_; }

 private:
  std::span<const std::byte> pending() const { return std::span(buffer_).subspan(read_); }
  /// Bytes of the packet at the front: 0 if there is none, unset if it is not all here yet.
  std::optional<std::size_t> sound_packet() const;
  void skip(std::size_t bytes);
  void skip_to_magic();

  std::vector<std::byte> buffer_;
  std::size_t read_ = 0;
  bool in_step_ = true;  ///< the last byte consumed ended an accepted packet
  bool finished_ = false;
  WireDamage damage_;
};

}  // namespace wobblebench::hw
