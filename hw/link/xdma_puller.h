// The thread that reads a card's node, and the queue between it and the link.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <span>
#include <string>

#include "hw/link/byte_queue.h"
#include "hw/link/device_gone.h"
#include "hw/link/link.h"
#include "hw/link/xdma_node.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

/// Shared by the link and its thread: a read of the driver cannot be broken off, so the thread may
/// outlive the link, and then closes the node itself.
class XdmaPuller {
 public:
  /// Takes an open node. `name` goes before every reason.
  XdmaPuller(XdmaNode node, std::string name, std::size_t transfer_bytes);

  /// The thread: reads until the stream ends or close(), then closes the node.
  void run();

  // Any thread.
  ReadResult take(std::span<std::byte> to, HostTime deadline);
  void cancel();
  void resume();
  void close();
  /// The node is closed. Waits for it until `deadline`.
  bool ended_before(HostTime deadline);
  std::string loss() const;

  std::size_t queued_transfers() const { return queued_transfers_; }

 private:
  struct Free {
    void operator()(std::byte* memory) const { std::free(memory); }
  };

  bool wait_for_room();
  /// One transfer. False: the stream has ended, `ending_` says how.
  bool pull();
  bool accept(std::span<const std::byte> transfer);
  bool nothing_came();
  bool failed(int error_number);
  bool end(ReadStatus how, const std::string& why);
  /// False: close() was called.
  bool wait_for_fifo() const;

  XdmaNode node_;        ///< only the thread
  FileDescriptor wake_;  ///< an eventfd: ends the wait for a FIFO
  const std::string name_;
  const std::size_t transfer_bytes_;
  const std::size_t queued_transfers_;
  const std::unique_ptr<std::byte, Free> transfer_;  ///< aligned; only the thread
  DeviceGoneDetector ones_;                          ///< only the thread

  mutable std::mutex mutex_;  ///< guards what follows
  std::condition_variable changed_;
  ByteQueue queue_;
  bool cancelled_ = false;
  bool closed_ = false;
  bool node_closed_ = false;
  ReadStatus ending_ = ReadStatus::ok;  ///< ok: not ended
  std::string loss_;
};

}  // namespace wobblebench::hw
