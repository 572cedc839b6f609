// Model of a capture card with DMA: packets fill the buffers of a ring, interrupts announce full
// buffers to the host. In device time; no threads and no waiting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "hw/probe/clock.h"
#include "sim/options.h"

namespace wobblebench::sim {

/// A packet that does not fit into the free buffers is dropped whole, as the firmware of a card has
/// to do: the sequence numbers show the gap. A buffer is free again when the host has read all of
/// it.
class CardModel {
 public:
  /// Throws InvalidOption, also if more buffers an interrupt are asked for than there are.
  explicit CardModel(const CardOptions& options);

  /// Stores a packet that is complete at `time`, not before the packet before it. `ends_volume`:
  /// flushes.
  void push(std::span<const std::byte> packet, hw::DeviceTime time, bool ends_volume);

  /// Completes the buffer under way, full or not, and raises an interrupt.
  void flush();

  /// Copies bytes that interrupts up to `now` have announced.
  std::size_t read(std::span<std::byte> buffer, hw::DeviceTime now);

  /// Time of the interrupt that announces the oldest unread bytes; none if it is not known yet.
  std::optional<hw::DeviceTime> next_interrupt() const;
  /// When the last byte of the packets so far has come over the PCIe link: their DMA is complete.
  hw::DeviceTime transfer_end() const { return transfer_end_; }
  /// Whether read() would copy bytes.
  bool readable(hw::DeviceTime now) const;

  std::uint64_t packets_dropped() const { return packets_dropped_; }

 private:
  struct Buffer {
    std::vector<std::byte> bytes;
    std::size_t read = 0;
    std::optional<hw::DeviceTime> interrupt;
  };

  void append(std::span<const std::byte> bytes);
  void complete_buffer();
  void raise_interrupt();
  std::size_t free_bytes() const;

  const CardOptions options_;
  std::deque<Buffer> ring_;                   ///< buffers in use, oldest first
  std::vector<std::vector<std::byte>> free_;  ///< memory of buffers that are free again
  int pending_ = 0;                           ///< complete buffers before their interrupt
  bool filling_ = false;                      ///< ring_.back() is not complete
  hw::DeviceTime transfer_end_{};             ///< of the last byte over the PCIe link
  std::uint64_t packets_dropped_ = 0;
};

}  // namespace wobblebench::sim
