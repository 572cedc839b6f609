// The link to a real card: the character device of the Xilinx/AMD XDMA driver, which most boards
// with an FPGA on PCIe use (/dev/xdma0_c2h_0). A FIFO with the same bytes is read the same way.
//
// What the driver gives (Xilinx dma_ip_drivers, cdev_sgdma.c): read and ioctl, neither poll nor
// mmap; one opener; reads that block until a packet has ended or the driver's patience has, 10 s.
// So a thread of the link sits inside read(2), and the program waits for the thread's queue.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "base/options.h"
#include "base/units.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

struct XdmaLinkOptions {
  /// One transfer, KiB: a multiple of the engine's alignment. A stick of the paper has 2.
  int transfer_kb = 64;
  /// A transfer ends where a packet ends, so that no stick waits for later ones to fill it. Asks
  /// for the right to write to the node too: the driver is told by O_TRUNC.
  bool end_of_packet = true;
  /// How long opening waits for another program, or for a closed link's last read, to let go, s.
  double busy_patience_s = 1;
};

template <OptionsOf<XdmaLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("transfer_kb", o.transfer_kb, 1, 16384);
  v.flag("end_of_packet", o.end_of_packet);
  v.real("busy_patience_ms", o.busy_patience_s, kMillisecond, 0, 60000);
}

class XdmaPuller;
enum class XdmaNodeKind;

/// Copies in. A card keeps its own pace: where the program does not keep up with it, a queue of
/// 4 MiB (at least 4 transfers) fills, then the card overruns, which the sequence numbers show. A
/// FIFO waits.
///
/// A read of the driver is never broken off, for that would lose what it has: close() leaves the
/// thread inside it alone, and the node stays busy until the read returns: at once while the card
/// sends, after the driver's patience (10 s) where it is silent.
///
/// A read that the driver gave up waiting is neither an end nor a loss. Lost is a card that gives
/// an error (ENODEV, EIO, …), or reads all ones for longer than a packet can. A FIFO ends when its
/// last writer closes it.
class XdmaLink : public Link {
 public:
  /// Opens a character device, a FIFO, or the file of a stand-in (on FUSE). Throws LinkOpenError,
  /// InvalidOption.
  explicit XdmaLink(const std::filesystem::path& path, const XdmaLinkOptions& options = {});
  ~XdmaLink() override;

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override;
  void resume() override;
  /// Returns within 10 ms.
  void close() override;
  LinkCapabilities capabilities() const override;
  std::string loss() const override;

 private:
  XdmaNodeKind kind_;
  std::size_t transfer_bytes_;
  std::shared_ptr<XdmaPuller> puller_;
  std::thread thread_;
};

}  // namespace wobblebench::hw
