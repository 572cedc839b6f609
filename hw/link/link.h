// Where a board's bytes come from: a stream with deadlines. What differs between the card, the
// simulator and a recording is only this.
#pragma once

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

#include "hw/probe/clock.h"
#include "hw/wire/stream_origin.h"

namespace wobblebench::hw {

enum class ReadStatus {
  ok,             ///< at least one byte was read
  timeout,        ///< the deadline passed with nothing to read
  end_of_stream,  ///< there will be nothing more
  cancelled,      ///< cancel() was called
  lost,           ///< the device is gone; terminal
};

struct ReadResult {
  std::size_t bytes = 0;  ///< more than 0 exactly if status is ok
  ReadStatus status = ReadStatus::ok;
};

/// What a link is. Sizes are 0 where the link has no such thing.
struct LinkCapabilities {
  StreamOrigin origin = StreamOrigin::simulated;
  bool copy_in = true;  ///< read() copies; false: the bytes lie in memory shared with the device
  /// True: the source waits for its reader, nothing is lost by reading slowly (a file).
  /// False: the source keeps its own pace and overruns (a card).
  bool waits_for_reader = true;
  std::size_t buffer_bytes = 0;   ///< one transfer buffer of the device
  int buffers = 0;                ///< transfer buffers in the device's ring
  int buffers_per_interrupt = 0;  ///< how many fill before the reader is woken
};

/// Why a link cannot be opened.
enum class OpenFault {
  missing,        ///< there is no such file or device
  not_permitted,  ///< it may not be read by this user
  wrong_kind,     ///< a folder, say
  busy,           ///< another program has it open
  gone,           ///< it is there and does not answer
  empty,          ///< a recording without a byte
  foreign,        ///< holds no packet of the wire format
  later_version,  ///< of a wire format that this program cannot read
};

/// what() is one line: "PATH: what is wrong; what is allowed".
class LinkOpenError : public std::runtime_error {
 public:
  LinkOpenError(OpenFault fault, const std::string& what)
      : std::runtime_error(what), fault_(fault) {}
  OpenFault fault() const { return fault_; }

 private:
  OpenFault fault_;
};

/// A link is opened by the constructor or factory of its class, which throws LinkOpenError if the
/// device or file cannot be opened, and InvalidOption for bad arguments; a Link object is an open
/// link.
///
/// Threads: one thread at a time calls read(), resume(), loss() and close(). cancel() and
/// capabilities() may be called from any thread at any time, also while another is inside read().
/// What goes wrong with an open link is a ReadStatus; its functions do not throw.
class Link {
 public:
  virtual ~Link() = default;

  /// Reads at most `buffer.size()` bytes, at least one, waiting for the first until `deadline` at
  /// most. A deadline in the past polls. Packets may be cut anywhere. `buffer` is not empty.
  virtual ReadResult read(std::span<std::byte> buffer, HostTime deadline) = 0;

  /// Wakes a thread inside read() within 10 ms; that read and every later one gives `cancelled`,
  /// without losing bytes, until resume(). May be repeated.
  virtual void cancel() = 0;

  /// Ends the effect of cancel(). Called while no thread is inside read().
  virtual void resume() = 0;

  /// Gives the device back. Later reads give `lost`. May be repeated.
  virtual void close() = 0;

  virtual LinkCapabilities capabilities() const = 0;

  /// Why a read gave `lost`, in one line.
  virtual std::string loss() const { return "the device is gone"; }
};

}  // namespace wobblebench::hw
