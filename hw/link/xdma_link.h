// The link to a real card: the character device of the Xilinx/AMD XDMA driver, which most boards
// with an FPGA on PCIe use (/dev/xdma0_c2h_0). A FIFO with the same bytes is read the same way.
//
// The driver (Xilinx dma_ip_drivers, cdev_sgdma.c) has read and ioctl, neither poll nor mmap; one
// opener; reads that block until a packet has ended or until its timeout, 10 s. So a thread of the
// link blocks in read(2), and the program waits for that thread's queue.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "base/options.h"
#include "base/units.h"
#include "hw/link/link.h"

namespace wobblebench::hw {

struct XdmaLinkOptions {
  /// Size of a transfer, KiB: a multiple of the engine's alignment. A stick of the paper has 2.
  int transfer_kb = 64;
  /// A transfer ends where a packet ends, so that no stick waits for later ones to fill it. Needs
  /// write permission on the node: the driver is told by O_TRUNC.
  bool end_of_packet = true;
  /// How long opening waits while another program, or a closed link's last read, has the node, s.
  double busy_patience_s = 1;
};

template <OptionsOf<XdmaLinkOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("transfer_kb", o.transfer_kb, 1, 16384);
  v.flag("end_of_packet", o.end_of_packet);
  v.real("busy_patience_ms", o.busy_patience_s, kMillisecond, 0, 60000);
}

class XdmaReader;
enum class XdmaNodeKind;

/// Copies in. A card does not wait: if the program reads too slowly, a queue of 4 MiB (at least 4
/// transfers) fills, then the card overruns, which the sequence numbers show. A FIFO waits.
///
/// A read of the driver is never interrupted, as that would lose its data: close() detaches the
/// thread inside it, and the node stays busy until the read returns: at once while the card sends,
/// after the driver's timeout (10 s) where it does not.
///
/// A read that timed out is neither an end nor a loss. The device is lost if the card gives an
/// error (ENODEV, EIO, …), or reads all ones for longer than a packet can. A FIFO ends when its
/// last writer closes it.
///
/// @code
/// #include "hw/board/board.h"
/// hw::XdmaLinkOptions options;
/// options.transfer_kb = 128;
/// hw::Board board(std::make_unique<hw::XdmaLink>("/dev/xdma0_c2h_0", options));
/// board.start();
/// const hw::Event first = board.next(hw::HostClock::now() + std::chrono::seconds(1));
/// if (std::holds_alternative<hw::TimedOut>(first)) board.close();
/// @endcode
class XdmaLink : public Link {
 public:
  /// Opens a character device, a FIFO, or the file of an emulator (on FUSE). Throws LinkOpenError,
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
  std::shared_ptr<XdmaReader> reader_;
  std::jthread thread_;
};

}  // namespace wobblebench::hw
