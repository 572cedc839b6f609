// What a capture card does between the probe and the program: packets become bytes in DMA buffers,
// and the program learns of them at interrupts. In device time, without threads and without
// waiting.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "base/options.h"
#include "base/units.h"
#include "hw/probe/clock.h"

namespace wobblebench::sim {

/// Defaults: a small ring of LitePCIe's 8 KiB buffers, each with its interrupt, behind one lane of
/// PCIe 3.0 at 256 bytes a packet (references 17, 18).
struct CardOptions {
  int buffer_bytes = 8192;
  int buffers = 256;
  /// The program learns of buffers when so many are full, or when a volume ends.
  int buffers_per_interrupt = 1;
  double payload_rate_mb_s = 900;  ///< 1e6 bytes a second over the link
  double interrupt_latency_s = 0;  ///< from the last buffer's end to the program's waking
};

template <OptionsOf<CardOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("buffer_bytes", o.buffer_bytes, 64, 1 << 24);
  v.integer("buffers", o.buffers, 2, 1 << 16);
  v.integer("buffers_per_interrupt", o.buffers_per_interrupt, 1, 1 << 16);
  v.real("payload_rate_mb_s", o.payload_rate_mb_s, 1, 0.1, 100000);
  v.real("interrupt_latency_us", o.interrupt_latency_s, kMicrosecond, 0, 1e6);
}

/// A packet that does not fit into the free buffers is dropped whole, as a card's firmware has to:
/// the sequence numbers show it. A buffer is free again once the program has read all of it.
class CardModel {
 public:
  /// Throws InvalidOption, also for more buffers an interrupt than there are.
  explicit CardModel(const CardOptions& options);

  /// A packet is complete in the card at `time`, not before the packet before it. `ends_volume`:
  /// its buffer is handed over though it is not full.
  void put(std::span<const std::byte> packet, hw::DeviceTime time, bool ends_volume);

  /// Hands over what is there: the probe sends no more.
  void finish();

  /// Copies what interrupts up to `now` have announced.
  std::size_t read(std::span<std::byte> buffer, hw::DeviceTime now);

  /// When the next bytes that are not announced yet will be; none while no interrupt is due.
  std::optional<hw::DeviceTime> next_interrupt() const;
  /// Bytes that the program may read at `now`.
  bool readable(hw::DeviceTime now) const;

  std::uint64_t packets_dropped() const { return packets_dropped_; }

 private:
  struct Buffer {
    std::vector<std::byte> bytes;
    std::size_t read = 0;
    std::optional<hw::DeviceTime> announced;
  };

  void append(std::span<const std::byte> bytes);
  void hand_over();
  void announce();
  std::size_t free_bytes() const;

  const CardOptions options_;
  std::deque<Buffer> ring_;                    ///< oldest first; those in use
  std::vector<std::vector<std::byte>> spare_;  ///< storage of buffers that are free again
  int unannounced_ = 0;                        ///< full buffers that no interrupt has announced
  bool open_ = false;                          ///< ring_.back() takes more bytes
  hw::DeviceTime transferred_{};               ///< when the last byte came over the link
  std::uint64_t packets_dropped_ = 0;
};

}  // namespace wobblebench::sim
