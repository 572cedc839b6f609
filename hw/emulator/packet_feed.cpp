#include "hw/emulator/packet_feed.h"

#include <algorithm>
#include <thread>

#include "hw/wire/layout.h"

namespace wobblebench::hw {

std::size_t PacketFeed::pull(std::span<std::byte> to, HostTime deadline) {
  const ReadResult result = source_->read(to, deadline);
  lost_ = lost_ || result.status == ReadStatus::lost;
  // A source that has ended is emulated as a card that sends nothing.
  if (result.status == ReadStatus::end_of_stream) std::this_thread::sleep_until(deadline);
  return result.bytes;
}

bool PacketFeed::wait_for_packet(HostTime deadline) {
  if (bytes_left() > 0) return true;
  while (header_filled_ < kWireHeaderBytes) {
    const std::size_t count = pull(std::span(header_).subspan(header_filled_), deadline);
    if (count == 0) return false;
    header_filled_ += count;
  }
  const auto payload_bytes =
      wire_layout::get<std::uint32_t>(header_, wire_layout::kPayloadBytesOffset);
  payload_left_ = payload_bytes <= kWireMaxPayloadBytes ? payload_bytes : 0;
  header_filled_ = 0;
  header_taken_ = 0;
  has_header_ = true;
  ++packets_started_;
  return true;
}

std::size_t PacketFeed::take(std::span<std::byte> to, HostTime deadline) {
  if (header_left() > 0) {
    const auto from = std::span(header_).subspan(header_taken_);
    const std::size_t count = std::min(to.size(), from.size());
    std::copy_n(from.begin(), count, to.begin());
    header_taken_ += count;
    return count;
  }
  const std::size_t count = pull(to.first(std::min(to.size(), payload_left_)), deadline);
  payload_left_ -= count;
  return count;
}

}  // namespace wobblebench::hw
