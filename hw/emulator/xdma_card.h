// The behaviour of the card and its driver, without the file system.
#pragma once

#include <array>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "hw/emulator/xdma_emulator.h"
#include "hw/link/link.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// Reads a source packet by packet, as a card passes packets to its DMA engine. Frames by the
/// payload length of the header only, so that damage of the source is passed on. Not
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

/// Opens a source of the card's bytes, a new one at every call.
using LinkSource = std::function<std::unique_ptr<Link>()>;

/// Functions return what the driver's would: a count, or a negative errno. All may be called from
/// any thread.
class XdmaCard {
 public:
  XdmaCard(LinkSource source, const XdmaEmulatorOptions& options);

  /// EBUSY while it is open already, ENODEV while unplugged. `handle` identifies the opening.
  [[nodiscard]] int open(bool end_of_packet, std::uint64_t& handle);
  /// A release() will follow soon: an open() waits for it instead of returning EBUSY.
  void expect_release(std::uint64_t handle);
  void release(std::uint64_t handle);

  /// One transfer. `interrupted` is polled; it returns true where the reader was killed.
  [[nodiscard]] std::ptrdiff_t read(std::uint64_t handle,
                                    std::span<std::byte> to,
                                    const std::function<bool()>& interrupted);

  bool is_plugged() const;
  /// Existing openings return ENODEV for good.
  void unplug();
  void replug();
  /// The card sends nothing, or continues.
  void stall(bool stalled);

  const XdmaEmulatorOptions& options() const { return options_; }

 private:
  /// From an open() to its release().
  struct Opening {
    Opening(std::unique_ptr<Link> source, bool whole_packets)
        : feed(std::move(source)), end_of_packet(whole_packets) {}
    std::mutex transfer;  ///< held for a whole read: the engine does one at a time
    PacketFeed feed;
    const bool end_of_packet;
    std::uint64_t reads = 0;
    bool stalled_once = false;
  };
  struct Transfer;

  std::shared_ptr<Opening> opening(std::uint64_t handle) const;
  std::ptrdiff_t run(Transfer& transfer);
  /// Applies the faults of the options at the start of a packet; false if the card is stalled.
  bool start_packet(Opening& opening);
  bool is_stalled() const;
  bool reads_all_ones(const Opening& opening) const;
  bool fill(Transfer& transfer, HostTime until);

  const LinkSource source_;
  const XdmaEmulatorOptions options_;

  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable changed_;
  std::map<std::uint64_t, std::shared_ptr<Opening>> openings_;
  std::uint64_t last_handle_ = 0;
  std::uint64_t current_handle_ = 0;  ///< of the current opening; 0: none
  bool release_follows_ = false;      ///< of the current opening
  bool plugged_ = true;
  bool stalled_ = false;
};

}  // namespace wobblebench::hw
