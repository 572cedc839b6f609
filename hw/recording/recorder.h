// Writes what a link sends, as it comes, and keeps account of it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "hw/link/link.h"
#include "hw/wire/decoder.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {

struct RecorderOptions {
  int volumes = 0;  ///< stop after this many volume ends; 0: when the link ends
};

template <OptionsOf<RecorderOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  v.integer("volumes", o.volumes, 0, 1 << 30);
}

/// Why a recording ended.
enum class RecordingEnd { volumes, end_of_stream, lost, asked };

struct RecordingProgress {
  std::uint64_t bytes = 0;  ///< given to the sink
  std::uint64_t volumes = 0;
  BoardAccount account;
  WireDamage damage;
  std::optional<Configuration> configuration;
};

/// One thread uses it.
class Recorder {
 public:
  /// `sink` is given all bytes in order; what it throws ends the recording and passes through.
  using Sink = std::function<void(std::span<const std::byte>)>;
  Recorder(Link& link, Sink sink, const RecorderOptions& options = {});

  /// Reads until the end, or until `asked()` is true, which is looked at ten times a second at
  /// least. With a bound the recording ends with the last volume's end, else where the link's bytes
  /// do; `after_volume`, if given, is called after each volume end was given to the sink.
  /// Throws UnsupportedWireVersion, std::runtime_error for an impossible configuration.
  RecordingEnd run(const std::function<bool()>& asked,
                   const std::function<void(const RecordingProgress&)>& after_volume = {});

  const RecordingProgress& progress() const { return progress_; }

 private:
  /// Bytes of the chunk that belong to the recording; all, unless it ends within.
  std::size_t audit(std::span<const std::byte> chunk);

  Link& link_;
  const Sink sink_;
  const RecorderOptions options_;
  PacketFramer framer_;
  StreamAudit audit_;
  std::uint64_t fed_ = 0;
  RecordingProgress progress_;
};

}  // namespace wobblebench::hw
