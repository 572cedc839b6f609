// Records the bytes of a link and counts its losses.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "base/options.h"
#include "hw/link/link.h"
#include "hw/wire/account.h"
#include "hw/wire/configuration.h"
#include "hw/wire/unreadable_stream.h"

namespace wobblebench::hw {

struct RecorderOptions {
  int volumes = 0;  ///< stop after this many volume ends; 0: at the end of the stream
};

template <OptionsOf<RecorderOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("volumes", o.volumes, 0, 1 << 30);
}

/// Why a recording ended.
enum class RecordingEnd { volumes, end_of_stream, lost, stop_requested };

struct RecordingProgress {
  std::uint64_t bytes = 0;        ///< given to the sink
  std::uint64_t whole_bytes = 0;  ///< of them, up to the end of the last whole packet
  std::uint64_t volumes = 0;
  std::uint64_t acquisitions = 0;   ///< one after the other
  std::uint64_t next_sequence = 0;  ///< of the stick after the last one known to be emitted
  BoardAccount account;
  WireDamage damage;
  std::optional<Configuration> configuration;
};

/// Copies the bytes of a link to a sink, and audits them on the way. Used by one thread.
///
/// @code
/// #include "hw/recording/file_link.h"
/// hw::FileLink link("scan.wbst");
/// std::vector<std::byte> bytes;
/// const auto append = [&](auto part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
/// hw::Recorder recorder(link, append, {.volumes = 10});
/// const hw::RecordingEnd end = recorder.run([] { return false; });
/// if (end == hw::RecordingEnd::lost) throw std::runtime_error(link.loss());
/// @endcode
class Recorder {
 public:
  /// Called with all bytes in order; an exception of it ends the recording and is passed on.
  using Sink = std::function<void(std::span<const std::byte>)>;
  /// `link` must outlive this. Throws InvalidOption.
  Recorder(Link& link, Sink sink, const RecorderOptions& options = {});
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Reads until the end, or until `stop_requested()`, called at least ten times a second, returns
  /// true. With a number of volumes the recording ends with the last one's end (a packet's length
  /// later where damage hides it), else with the link's bytes; `after_volume`, if given, is called
  /// after each volume end was given to the sink. The sink may have got a part of a packet after
  /// progress().whole_bytes, where the stream ended. Throws UnreadableStream where the stream
  /// cannot be interpreted from a packet on, once the sink was given all before it, and after
  /// kMostSkippedBytes without a packet.
  [[nodiscard]] RecordingEnd run(
      const std::function<bool()>& stop_requested,
      const std::function<void(const RecordingProgress&)>& after_volume = {});

  const RecordingProgress& progress() const;

 private:
  class Impl;

  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::hw
