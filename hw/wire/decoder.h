// Bytes of a stream to what its packets say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hw/wire/packet.h"
#include "hw/wire/packet_frame.h"

namespace wobblebench::hw {

/// What one framed packet of this version says; none if a field has a value that the format does
/// not know. `packet` is a frame's bytes, of a kind that this version has.
std::optional<Packet> parse_packet(std::span<const std::byte> packet);

/// Incremental parser: bytes in, in pieces of any size; packets out. Not thread-safe.
class Decoder {
 public:
  void feed(std::span<const std::byte> bytes) { framer_.feed(bytes); }

  /// No more bytes will come for now: what looks like the beginning of a long packet is damage.
  void finish() { framer_.finish(); }

  /// The next packet, or none until more bytes are fed. Throws UnsupportedWireVersion, at every
  /// call from then on, where a packet with a right CRC has a later version.
  std::optional<Packet> next();

  const WireDamage& damage() const { return framer_.damage(); }
  /// Bytes fed that are neither decoded nor skipped yet.
  std::size_t pending_bytes() const { return framer_.pending_bytes(); }

 private:
  PacketFramer framer_;
  std::optional<std::uint16_t> later_version_;
};

}  // namespace wobblebench::hw
