// Reads a source packet by packet, as a card passes packets to its DMA engine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "hw/link/link.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// Frames by the payload length of the header only, so that damage of the source is passed on. Not
/// thread-safe.
class PacketFeed {
 public:
  explicit PacketFeed(std::unique_ptr<Link> source) : source_(std::move(source)) {}

  /// Waits until `deadline` for the header of the current packet; true if it is there.
  [[nodiscard]] bool wait_for_packet(HostTime deadline);

  /// Moves bytes of the current packet to `to`, waiting for the first until `deadline`; returns
  /// their number.
  [[nodiscard]] std::size_t take(std::span<std::byte> to, HostTime deadline);

  /// Bytes of the current packet that are not taken yet; 0 before the header of the next one.
  std::size_t bytes_left() const { return header_left() + payload_left_; }
  /// Packets started so far: while bytes_left() is 0, the index of the next packet, from 0.
  std::int64_t packets_started() const { return packets_started_; }
  /// The source has lost its device.
  bool lost() const { return lost_; }

 private:
  std::size_t header_left() const { return has_header_ ? kWireHeaderBytes - header_taken_ : 0; }
  std::size_t pull(std::span<std::byte> to, HostTime deadline);

  const std::unique_ptr<Link> source_;
  std::array<std::byte, kWireHeaderBytes> header_{};
  std::size_t header_filled_ = 0;
  std::size_t header_taken_ = 0;
  std::size_t payload_left_ = 0;
  bool has_header_ = false;  ///< the header of the current packet is complete
  std::int64_t packets_started_ = 0;
  bool lost_ = false;
};

}  // namespace wobblebench::hw
