// The version of the wire format.
#pragma once

#include <cstdint>
#include <string>

#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {

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
