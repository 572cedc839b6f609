// Decoder of a byte stream into packets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hw/wire/account.h"
#include "hw/wire/packet.h"
#include "hw/wire/packet_frame.h"

namespace wobblebench::hw {

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
  /// Bytes skipped since the last packet.
  std::uint64_t skipped_in_a_row() const { return framer_.skipped_in_a_row(); }
  /// Bytes fed that are neither decoded nor skipped yet.
  std::size_t pending_bytes() const { return framer_.pending_bytes(); }

 private:
  PacketFramer framer_;
  std::optional<std::uint16_t> later_version_;
};

}  // namespace wobblebench::hw
