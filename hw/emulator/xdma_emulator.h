// Emulates a card and its XDMA driver: a file that a program opens and reads like the device's
// node. The file is called xdma0_c2h_0, on a FUSE file system of this process.
//
// Like the driver: one opener, EBUSY for others; O_TRUNC at open makes a read end where a packet
// ends; EINVAL for a length that is not aligned; the ioctl for the alignment; ETIMEDOUT, or a short
// read, after the driver's timeout; ENODEV once unplugged, and no node until replugged.
//
// Not emulated: DMA, the IOMMU, interrupts and their latency, the throughput of PCIe, and the
// effects of removing a real card on the machine. The buffer's address is not available, so a
// misaligned one is not refused; a read of more than 1 MiB is split; and the emulator never
// overruns by itself: its source does (sim's link), or waits. Its node is a regular file.
//
// If the process is killed, an empty mount remains: `fusermount3 -u FOLDER`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "base/options.h"
#include "base/units.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

/// Packet indices start at 0 at every opening of the node; −1: never.
struct XdmaEmulatorOptions {
  /// Of the length of a read, bytes; a power of two.
  int alignment_bytes = 1;
  /// After this time a read returns what it has, or ETIMEDOUT, s. The driver's default.
  double timeout_s = 10;
  bool short_reads = false;  ///< reads end early, at random lengths (seed)
  std::uint64_t seed = 1;
  int stall_at_packet = -1;     ///< stalls before this packet, until stall(false)
  int unplug_at_packet = -1;    ///< unplugs before this packet
  int all_ones_at_packet = -1;  ///< reads give 0xFF from this packet on
};

template <OptionsOf<XdmaEmulatorOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  constexpr int kAnyPacket = 1'000'000'000;
  v.integer("alignment_bytes", o.alignment_bytes, 1, 4096);
  v.real("timeout_ms", o.timeout_s, kMillisecond, 1, 60000);
  v.flag("short_reads", o.short_reads);
  v.seed("seed", o.seed);
  v.integer("stall_at_packet", o.stall_at_packet, -1, kAnyPacket);
  v.integer("unplug_at_packet", o.unplug_at_packet, -1, kAnyPacket);
  v.integer("all_ones_at_packet", o.all_ones_at_packet, -1, kAnyPacket);
}

class FuseSession;
class XdmaCard;

/// All functions may be called from any thread.
class XdmaEmulator {
 public:
  /// Opens a source of the card's bytes; called at every opening of the node, on a thread of the
  /// emulator.
  using Source = std::function<std::unique_ptr<Link>()>;

  /// Mounts on `folder`, which must exist. Throws std::runtime_error where that fails,
  /// InvalidOption.
  XdmaEmulator(const std::filesystem::path& folder,
               Source source,
               const XdmaEmulatorOptions& options = {});
  /// Ends reads with ENODEV, and unmounts. Later calls on an open node give ENOTCONN.
  ~XdmaEmulator();

  /// FOLDER/xdma0_c2h_0.
  std::filesystem::path path() const;

  /// Removes the card: its node disappears, reads of an open node give ENODEV for good.
  void unplug();
  void replug();
  /// The card sends nothing, or continues.
  void stall(bool stalled);

  /// Whether FUSE can be mounted on this machine. Tried once per process.
  static bool can_mount();
  /// Empty if can_mount().
  static std::string mount_error();

 private:
  std::filesystem::path folder_;
  std::unique_ptr<XdmaCard> card_;
  std::unique_ptr<FuseSession> session_;
};

}  // namespace wobblebench::hw
