// What ends a stream before its bytes do: from some packet on nothing can be interpreted.
#pragma once

#include <cstdint>
#include <stdexcept>

namespace wobblebench::hw {

/// A later version of the format, a configuration that is not possible, numbers that cannot be
/// counted, or no packet at all. What came before stays valid. what() is one line.
///
/// @code
/// #include "hw/recording/recorder.h"
/// const auto record = [](hw::Link& link, const hw::Recorder::Sink& sink) {
///   hw::Recorder recorder(link, sink);
///   try {
///     return recorder.run([] { return false; });
///   } catch (const hw::UnreadableStream&) {
///     return hw::RecordingEnd::lost;  // the sink has all that came before
///   }
/// };
/// static_cast<void>(record);
/// @endcode
class UnreadableStream : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The most bytes in a row without a sound packet that a reader of a device takes: a thousand times
/// the longest packet, 7 s of the paper's stream. Damage ends with the next sound packet, so that a
/// device which goes on beyond this sends something else. Bytes count, not time: a slow device is
/// never given up. Inspection and salvage of a file have no such limit.
inline constexpr std::uint64_t kMostSkippedBytes = 64 << 20;

/// Throws UnreadableStream where more were skipped in a row.
inline void check_skipped(std::uint64_t bytes_in_a_row) {
  if (bytes_in_a_row <= kMostSkippedBytes) return;
  throw UnreadableStream("no sound packet in 64 MiB: this is no stream of the wire format");
}

}  // namespace wobblebench::hw
