// Where packets begin and end in a stream of bytes: the half of decoding that needs no knowledge of
// what a packet says. Whoever copies, cuts or restamps packets works on these.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hw/probe/clock.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// A whole packet, sound as far as magic, header and CRC tell.
struct PacketFrame {
  std::span<const std::byte> bytes;  ///< header and payload; valid until the next feed()
  std::uint64_t offset = 0;          ///< of its first byte, from the start of the stream
};

/// The fields of a header that every kind has, docs/wire_format.md.
struct PacketStamp {
  std::uint64_t sequence = 0;
  std::uint32_t volume = 0;
  DeviceTime time{};
};

std::uint16_t packet_version(std::span<const std::byte> packet);
PacketKind packet_kind(std::span<const std::byte> packet);
/// False: a kind that this program does not know, and passes over.
bool is_known_kind(std::span<const std::byte> packet);
PacketStamp packet_stamp(std::span<const std::byte> packet);
/// Rewrites the stamp of a packet, and its CRC if it has one.
void restamp(std::span<std::byte> packet, const PacketStamp& stamp);

/// Incremental: bytes in, in pieces of any size; frames out. After damage it searches for the next
/// packet: magic, a sound header and a right CRC. Not thread-safe.
class PacketFramer {
 public:
  void feed(std::span<const std::byte> bytes);

  /// No more bytes will come for now: what looks like the beginning of a long packet is damage.
  void finish() { finished_ = true; }

  /// The next packet, or none until more bytes are fed.
  std::optional<PacketFrame> next();

  /// The packet that next() gave last says what this version does not know: it was damage.
  void refuse();

  const WireDamage& damage() const { return damage_; }
  /// Bytes fed that belong to no frame and are not skipped yet.
  std::size_t pending_bytes() const { return buffer_.size() - read_; }

 private:
  std::span<const std::byte> pending() const { return std::span(buffer_).subspan(read_); }
  /// Bytes of the packet at the front: 0 if there is none, unset if it is not all here yet.
  std::optional<std::size_t> sound_packet() const;
  void note_damage(std::size_t bytes);
  void skip_to_magic();

  std::vector<std::byte> buffer_;
  std::size_t read_ = 0;
  std::uint64_t consumed_ = 0;  ///< bytes of the stream before buffer_[read_]
  std::size_t last_bytes_ = 0;  ///< of the frame given last
  bool was_in_step_ = true;     ///< before that frame
  bool in_step_ = true;         ///< the last byte consumed ended a frame
  bool finished_ = false;
  WireDamage damage_;
};

}  // namespace wobblebench::hw
