// Reads a card's node on a thread, into the queue that the link takes from.
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

/// Shared by the link and its thread: a read of the driver cannot be interrupted, so the thread may
/// outlive the link, and then closes the node itself.
class XdmaReader {
 public:
  /// Takes an open node. `name` is the prefix of loss().
  XdmaReader(XdmaNode node, std::string name, std::size_t transfer_bytes);

  /// Body of the thread: reads until the stream ends or close(), then closes the node.
  void run();

  // The functions below may be called from any thread; they are those of Link.
  ReadResult read(std::span<std::byte> to, HostTime deadline);
  void cancel();
  void resume();
  void close();
  /// Waits until the node is closed, until `deadline` at most; true if it is closed.
  [[nodiscard]] bool wait_until_closed(HostTime deadline);
  std::string loss() const;

  std::size_t queued_transfers() const { return queued_transfers_; }

 private:
  struct Free {
    void operator()(std::byte* memory) const { std::free(memory); }
  };

  bool wait_for_room();
  // These return false where the thread has to end.
  bool read_transfer();
  bool accept(std::span<const std::byte> transfer);
  bool pause_when_idle();
  bool handle_error(int error_number);
  /// Sets `ending_` and the reason. Returns false.
  bool end(ReadStatus status, const std::string& reason);
  /// False: close() was called.
  bool wait_for_fifo() const;

  XdmaNode node_;        ///< used by the thread only
  FileDescriptor wake_;  ///< an eventfd: ends the wait for a FIFO
  const std::string name_;
  const std::size_t transfer_bytes_;
  const std::size_t queued_transfers_;
  const std::unique_ptr<std::byte, Free> transfer_;  ///< aligned; used by the thread only
  DeviceGoneDetector device_gone_;                   ///< used by the thread only

  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable changed_;
  ByteQueue queue_;
  bool cancelled_ = false;
  bool closed_ = false;
  bool node_closed_ = false;
  ReadStatus ending_ = ReadStatus::ok;  ///< ok: the stream has not ended
  std::string loss_;
};

}  // namespace wobblebench::hw
