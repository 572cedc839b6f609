// The version of the wire format, and what ends a stream before its bytes do: from some packet on
// nothing can be interpreted.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

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

/// Throws UnreadableStream where more were skipped in a row. `wrong_checksums`: packets so far of
/// which nothing but the CRC is wrong.
inline void check_skipped(std::uint64_t bytes_in_a_row, std::uint64_t wrong_checksums) {
  if (bytes_in_a_row <= kMostSkippedBytes) return;
  throw UnreadableStream(
      wrong_checksums == 0
          ? "no sound packet in 64 MiB: this is no stream of the wire format"
          : "no sound packet in 64 MiB: " + std::to_string(wrong_checksums) +
                " packets have a wrong checksum; it must be a CRC-32C (docs/wire_format.md)");
}

inline constexpr std::uint16_t kWireVersion = 1;

/// The stream has a version that this program cannot read.
///
/// @code
/// #include "hw/recording/recording.h"
/// try {
///   const hw::RecordingContents contents = hw::inspect_recording("scan.wbst");
/// } catch (const hw::UnsupportedWireVersion& error) {
///   if (error.version() > hw::kWireVersion) return;
/// }
/// @endcode
class UnsupportedWireVersion : public UnreadableStream {
 public:
  explicit UnsupportedWireVersion(std::uint16_t version)
      : UnreadableStream("wire format version " + std::to_string(version) +
                         ": this program reads version " + std::to_string(kWireVersion)),
        version_(version) {}
  std::uint16_t version() const { return version_; }

 private:
  std::uint16_t version_;
};

}  // namespace wobblebench::hw
