// Finds the packets of a byte stream, and decodes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw/probe/clock.h"
#include "hw/wire/account.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// A whole packet with valid magic, header and CRC.
struct PacketFrame {
  std::span<const std::byte> bytes;  ///< header and payload; valid until the next feed()
  std::uint64_t offset = 0;          ///< of its first byte, from the start of the stream
};

/// Header fields that every kind has.
struct PacketStamp {
  std::uint64_t sequence = 0;
  std::uint32_t volume = 0;
  DeviceTime time{};
};

// `packet` is at least a header.
std::uint16_t packet_version(std::span<const std::byte> packet);
PacketKind packet_kind(std::span<const std::byte> packet);
/// False: a kind that this program skips.
bool is_known_kind(std::span<const std::byte> packet);
PacketStamp packet_stamp(std::span<const std::byte> packet);
/// Rewrites the stamp of a whole packet, and its CRC if it has one.
void restamp(std::span<std::byte> packet, const PacketStamp& stamp);

/// Finds packets without parsing their payloads: enough to copy, cut or restamp them. Incremental:
/// bytes in, in pieces of any size; frames out. After damage it searches for the next
/// packet: magic, a valid header and a correct CRC. Not thread-safe.
class PacketFramer {
 public:
  void feed(std::span<const std::byte> bytes);

  /// No more bytes follow for now: an incomplete packet at the end is damage.
  void finish() { finished_ = true; }

  /// The next packet, or none until more bytes are fed.
  [[nodiscard]] std::optional<PacketFrame> next();

  /// Counts the packet that next() returned last as damage: it has an undefined field value.
  void reject_last();

  const WireDamage& damage() const { return damage_; }
  /// Packets so far with a valid header and a wrong CRC; their bytes are part of the damage.
  std::uint64_t wrong_checksums() const { return wrong_checksums_; }
  /// Bytes skipped since the last packet.
  std::uint64_t skipped_in_a_row() const { return in_sync_ ? 0 : skipped_; }
  /// Bytes fed that belong to no frame and are not skipped yet.
  std::size_t pending_bytes() const { return buffer_.size() - read_; }

 private:
  std::span<const std::byte> pending() const { return std::span(buffer_).subspan(read_); }
  /// Size of the packet at the front, bytes: 0 if there is none, unset if it is incomplete.
  std::optional<std::size_t> front_packet_bytes();
  void note_damage(std::size_t bytes);
  void skip_to_magic();

  std::vector<std::byte> buffer_;
  std::size_t read_ = 0;
  std::uint64_t consumed_ = 0;  ///< bytes of the stream before buffer_[read_]
  std::size_t last_bytes_ = 0;  ///< size of the frame returned last
  bool was_in_sync_ = true;     ///< before that frame
  bool in_sync_ = true;         ///< the last byte consumed ended a frame
  std::uint64_t skipped_ = 0;   ///< since the last packet; valid unless in_sync_
  bool finished_ = false;
  std::uint64_t wrong_checksums_ = 0;
  WireDamage damage_;
};

/// Parses one framed packet of this version and of a known kind; none if a field has a value that
/// the format does not define.
std::optional<Packet> parse_packet(std::span<const std::byte> packet);

/// Incremental parser: bytes in, in pieces of any size; packets out. Not thread-safe.
class Decoder {
 public:
  void feed(std::span<const std::byte> bytes) { framer_.feed(bytes); }

  /// No more bytes follow for now: an incomplete packet at the end is damage.
  void finish() { framer_.finish(); }

  /// The next packet, or none until more bytes are fed. Throws UnsupportedWireVersion, at this and
  /// every later call, where a packet with a correct CRC has a later version.
  [[nodiscard]] std::optional<Packet> next();

  const WireDamage& damage() const { return framer_.damage(); }
  /// As PacketFramer::wrong_checksums().
  std::uint64_t wrong_checksums() const { return framer_.wrong_checksums(); }
  /// Bytes skipped since the last packet.
  std::uint64_t skipped_in_a_row() const { return framer_.skipped_in_a_row(); }
  /// Bytes fed that are neither decoded nor skipped yet.
  std::size_t pending_bytes() const { return framer_.pending_bytes(); }

 private:
  PacketFramer framer_;
  std::optional<std::uint16_t> later_version_;
};

}  // namespace wobblebench::hw
