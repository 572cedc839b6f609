// Reads a card's node on a thread, into the queue that the link takes from.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "hw/link/link.h"
#include "hw/link/xdma_node.h"
#include "hw/probe/clock.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// First-in, first-out queue of bytes with a fixed capacity. Not thread-safe.
class ByteQueue {
 public:
  explicit ByteQueue(std::size_t capacity) : bytes_(capacity) {}

  std::size_t size() const { return size_; }
  std::size_t room() const { return bytes_.size() - size_; }

  /// `from` is not longer than room().
  void push(std::span<const std::byte> from) {
    while (!from.empty()) {
      const std::size_t at = (first_ + size_) % bytes_.size();
      const std::size_t count = std::min(from.size(), bytes_.size() - at);
      std::copy_n(from.begin(), count, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
      size_ += count;
      from = from.subspan(count);
    }
  }

  void push(std::size_t count, std::byte value) {
    for (; count > 0; --count) push(std::span(&value, 1));
  }

  /// Moves the oldest bytes to `to`; returns their number.
  std::size_t pop(std::span<std::byte> to) {
    std::size_t popped = 0;
    while (popped < to.size() && size_ > 0) {
      const std::size_t count = std::min({to.size() - popped, size_, bytes_.size() - first_});
      std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(first_),
                  count,
                  to.begin() + static_cast<std::ptrdiff_t>(popped));
      first_ = (first_ + count) % bytes_.size();
      size_ -= count;
      popped += count;
    }
    return popped;
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

/// Longest run of 0xFF in valid packets, bytes: a header, and samples that are all NaN.
inline constexpr std::size_t kLongestValidOnes = kWireHeaderBytes + 4 * kWireMaxSamples;

/// Detects that a card has left the PCIe bus: every byte read from it is then 0xFF. Inspects
/// transfers in order. Those of 0xFF only are held back until it is known whether they
/// are samples or the card is gone. Not thread-safe.
class DeviceGoneDetector {
 public:
  struct Result {
    std::size_t held_back = 0;  ///< bytes of 0xFF of earlier transfers, to pass on first
    std::size_t valid = 0;      ///< leading bytes of this transfer to pass on
    bool gone = false;          ///< the card has left the bus
  };

  [[nodiscard]] Result inspect(std::span<const std::byte> transfer);

  /// At the end of the stream: number of bytes of 0xFF that are held back, to pass on.
  [[nodiscard]] std::size_t end();

 private:
  std::size_t run_ = 0;        ///< bytes of 0xFF at the end of the stream so far
  std::size_t held_back_ = 0;  ///< of these
};

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
