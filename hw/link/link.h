// The interface of a byte stream with deadlines. The card, the simulator and a recording differ
// only in their link.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "base/options.h"
#include "hw/probe/clock.h"
#include "hw/wire/configuration.h"

namespace wobblebench::hw {

/// Rate at which a simulated or recorded link delivers its bytes.
enum class Pace {
  asap,      ///< as fast as they are read
  realtime,  ///< at the device's times, on the host's clock
};

template <OptionsOf<Pace> P, class Visitor>
void describe_pace(P& pace, Visitor& v) {
  v.choice("pace", pace, {{"asap", Pace::asap}, {"realtime", Pace::realtime}});
}

enum class ReadStatus {
  ok,             ///< at least one byte was read
  timeout,        ///< the deadline passed with nothing to read
  end_of_stream,  ///< no more bytes will come
  cancelled,      ///< cancel() was called
  lost,           ///< the device is gone; terminal
};

struct [[nodiscard]] ReadResult {
  std::size_t bytes = 0;  ///< more than 0 if and only if status is ok
  ReadStatus status = ReadStatus::ok;
};

/// Properties of a link. Sizes are 0 where they do not apply.
struct LinkCapabilities {
  StreamOrigin origin = StreamOrigin::simulated;
  bool copy_in = true;  ///< read() copies; false: the bytes lie in memory shared with the device
  /// True: the source waits for its reader, slow reading loses nothing (a file). False: the source
  /// has its own rate and overruns (a card).
  bool waits_for_reader = true;
  std::size_t buffer_bytes = 0;   ///< one transfer buffer of the device
  int buffers = 0;                ///< transfer buffers in the device's ring
  int buffers_per_interrupt = 0;  ///< filled buffers that wake the reader
};

/// Why a link cannot be opened.
enum class OpenFault {
  missing,        ///< no such file or device
  not_permitted,  ///< not readable by this user
  wrong_kind,     ///< a folder, say
  busy,           ///< another program has it open
  gone,           ///< exists, but does not answer
  empty,          ///< a recording of 0 bytes
  foreign,        ///< holds no packet of the wire format
  later_version,  ///< a later version of the wire format
};

/// what() is one line: "PATH: what is wrong; what is allowed".
///
/// @code
/// #include "hw/recording/file_link.h"
/// try {
///   const hw::FileLink link("scan.wbst");
/// } catch (const hw::LinkOpenError& error) {
///   if (error.fault() == hw::OpenFault::missing) return;
///   throw;
/// }
/// @endcode
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
/// Threads: one thread at a time calls read(), resume(), loss() and close(). cancel(),
/// capabilities() and epoch() may be called from any thread at any time, also while another is
/// inside read(). Errors of an open link are a ReadStatus; its functions do not throw.
///
/// @code
/// struct EmptyLink : hw::Link {
///   hw::ReadResult read(std::span<std::byte>, hw::HostTime) override {
///     return {0, hw::ReadStatus::end_of_stream};
///   }
///   void cancel() override {}
///   void resume() override {}
///   void close() override {}
///   hw::LinkCapabilities capabilities() const override { return {}; }
/// };
/// EmptyLink link;
/// if (link.capabilities().waits_for_reader) link.close();
/// @endcode
class Link {
 public:
  virtual ~Link() = default;

  /// Reads 1 to `buffer.size()` bytes, waiting for the first until `deadline` at most. A deadline
  /// in the past polls. Packets may be cut anywhere. `buffer` is not empty.
  virtual ReadResult read(std::span<std::byte> buffer, HostTime deadline) = 0;

  /// Wakes a thread inside read() within 10 ms; that read and every later one returns `cancelled`,
  /// without losing bytes, until resume(). May be repeated.
  virtual void cancel() = 0;

  /// Ends the effect of cancel(). Called while no thread is inside read().
  virtual void resume() = 0;

  /// Releases the device. Later reads return `lost`. May be repeated.
  virtual void close() = 0;

  virtual LinkCapabilities capabilities() const = 0;

  /// Host time of device time 0, by which the link paces its bytes: a stick is due to be fired at
  /// epoch() + its time. Moves on while the device waits for its source, or its reader pauses. None
  /// before the first read, and for a device that has a clock of its own or none. May be called
  /// from any thread at any time.
  virtual std::optional<HostTime> epoch() const { return {}; }

  /// Why a read returned `lost`, in one line.
  virtual std::string loss() const { return "the device is gone"; }
};

}  // namespace wobblebench::hw
