// The bytes of a source, packet by packet, as a card hands them to its DMA engine.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "hw/link/link.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// Frames by the header's payload length alone: what a source damages, the card sends on. Not
/// thread-safe.
class PacketFeed {
 public:
  explicit PacketFeed(std::unique_ptr<Link> source) : source_(std::move(source)) {}

  /// Waits until `deadline` for the header of the packet at hand; false: it did not come.
  bool await_packet(HostTime deadline);

  /// Moves bytes of that packet to `to`, waiting for the first until `deadline`; how many.
  std::size_t take(std::span<std::byte> to, HostTime deadline);

  /// Bytes of that packet that are not taken yet; 0 where the next one is still to come.
  std::size_t left() const { return header_left() + payload_left_; }
  /// Packets that were begun: the number of the next, from 0, while left() is 0.
  std::int64_t begun() const { return begun_; }
  /// The source lost its device.
  bool lost() const { return lost_; }

 private:
  std::size_t header_left() const { return begun_here_ ? kWireHeaderBytes - header_taken_ : 0; }
  std::size_t pull(std::span<std::byte> to, HostTime deadline);

  const std::unique_ptr<Link> source_;
  std::array<std::byte, kWireHeaderBytes> header_{};
  std::size_t header_filled_ = 0;
  std::size_t header_taken_ = 0;
  std::size_t payload_left_ = 0;
  bool begun_here_ = false;  ///< the header is whole
  std::int64_t begun_ = 0;
  bool lost_ = false;
};

}  // namespace wobblebench::hw
