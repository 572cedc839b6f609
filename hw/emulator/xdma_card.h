// What the card and its driver do, without the file system around them.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <span>

#include "hw/emulator/packet_feed.h"
#include "hw/emulator/xdma_emulator_options.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

/// Opens, anew at every call, the source of what the card sends.
using LinkSource = std::function<std::unique_ptr<Link>()>;

/// Calls give what the driver's would: a count, or the negative of an errno. All functions may be
/// called from any thread.
class XdmaCard {
 public:
  XdmaCard(LinkSource source, const XdmaEmulatorOptions& options);

  /// EBUSY while another has it open, ENODEV while unplugged. `handle` names the opening.
  int open(bool end_of_packet, std::uint64_t& handle);
  /// A release() follows soon: an open() waits for it instead of giving EBUSY.
  void expect_release(std::uint64_t handle);
  void release(std::uint64_t handle);

  /// One transfer. `interrupted` says, from time to time, that the reader was killed.
  std::ptrdiff_t read(std::uint64_t handle,
                      std::span<std::byte> to,
                      const std::function<bool()>& interrupted);

  bool is_plugged() const;
  /// For all who have it open, for ever: ENODEV.
  void unplug();
  void replug();
  /// Nothing comes, or comes again.
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
  /// What happens where the packet at hand begins; false if nothing can come now.
  bool begin_packet(Opening& opening);
  bool is_stalled() const;
  bool all_ones(const Opening& opening) const;
  bool fill(Transfer& transfer, HostTime until);

  const LinkSource source_;
  const XdmaEmulatorOptions options_;

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  std::map<std::uint64_t, std::shared_ptr<Opening>> openings_;
  std::uint64_t last_handle_ = 0;
  std::uint64_t holder_ = 0;      ///< who has the node; 0: nobody
  bool release_follows_ = false;  ///< of the holder
  bool plugged_ = true;
  bool stalled_ = false;
};

}  // namespace wobblebench::hw
