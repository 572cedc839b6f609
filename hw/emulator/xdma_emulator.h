// Stands in for a card and its XDMA driver: a file that a program opens and reads as it would the
// device's node. The file is called xdma0_c2h_0, on a FUSE file system of this process.
//
// Like the driver: one opener, EBUSY for others; O_TRUNC at open makes a read end where a packet
// ends; EINVAL for a length that is not aligned; the ioctl that asks for the alignment; ETIMEDOUT,
// or what came, after the driver's patience; ENODEV once unplugged, and no node until replugged.
//
// What it cannot show: DMA, the IOMMU, interrupts and their latency, the throughput of PCIe, and
// what a real card does to the machine when it leaves. It does not see a reader's address, so a
// misaligned one is not refused; a read of more than 1 MiB comes in pieces; and it never overruns
// by itself: its source does (sim's link), or waits. Its node is a regular file.
//
// If the process is killed, an empty mount stays: `fusermount3 -u FOLDER`.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "hw/emulator/xdma_emulator_options.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

class FuseSession;
class XdmaCard;

/// All functions may be called from any thread.
class XdmaEmulator {
 public:
  /// Opens what the card sends; called at every opening of the node, on a thread of the stand-in.
  using Source = std::function<std::unique_ptr<Link>()>;

  /// Mounts on `folder`, which must exist. Throws std::runtime_error where that cannot be done,
  /// InvalidOption.
  XdmaEmulator(const std::filesystem::path& folder,
               Source source,
               const XdmaEmulatorOptions& options = {});
  /// Ends reads with ENODEV, and unmounts. Whoever still has the node open gets ENOTCONN.
  ~XdmaEmulator();

  /// FOLDER/xdma0_c2h_0.
  std::filesystem::path path() const;

  /// The card leaves: its node goes, reads of those who have it open give ENODEV for good.
  void unplug();
  void replug();
  /// The card sends nothing, or goes on.
  void stall(bool stalled);

  /// A file system can be mounted here. Tries it once.
  static bool can_mount();
  /// Empty if can_mount().
  static std::string why_not();

 private:
  std::filesystem::path folder_;
  std::unique_ptr<XdmaCard> card_;
  std::unique_ptr<FuseSession> session_;
};

}  // namespace wobblebench::hw
