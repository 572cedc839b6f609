#include "hw/recording/recorder.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/options.h"
#include "hw/wire/decoder.h"
#include "hw/wire/stream_audit.h"

namespace wobblebench::hw {
namespace {

constexpr std::size_t kChunkBytes = 65536;
constexpr auto kStopPollInterval = std::chrono::milliseconds(100);

}  // namespace

class Recorder::Impl {
 public:
  Impl(Link& link, Sink sink, const RecorderOptions& options)
      : link_(link), sink_(std::move(sink)), options_(options) {
    check_options(options);
  }

  RecordingEnd run(const std::function<bool()>& stop_requested,
                   const std::function<void(const RecordingProgress&)>& after_volume);
  const RecordingProgress& progress() const { return progress_; }

 private:
  RecordingEnd read_link(const std::function<bool()>& stop_requested,
                         const std::function<void(const RecordingProgress&)>& after_volume);
  bool has_all_volumes() const {
    return options_.volumes > 0 &&
           progress_.volumes >= static_cast<std::uint64_t>(options_.volumes);
  }
  /// Returns the number of leading bytes of the chunk that belong to the recording: all, unless the
  /// last volume ends within, or the stream is unreadable from a packet on.
  /// `last`: no more bytes follow.
  std::size_t audit_chunk(std::span<const std::byte> chunk, bool last);
  /// Takes the next packet of framer_; false: there is none, or the last volume has ended.
  bool audit_next();
  /// True if the packet ends a volume.
  bool audit_packet(const Packet& packet);

  Link& link_;
  const Sink sink_;
  const RecorderOptions options_;
  PacketFramer framer_;
  StreamAudit audit_;
  std::uint64_t fed_ = 0;            ///< bytes given to framer_
  std::uint64_t packet_offset_ = 0;  ///< of the last packet, in the stream
  std::uint64_t packet_end_ = 0;
  std::exception_ptr unreadable_;
  RecordingProgress progress_;
};

Recorder::Recorder(Link& link, Sink sink, const RecorderOptions& options)
    : impl_(std::make_unique<Impl>(link, std::move(sink), options)) {}

Recorder::~Recorder() = default;

RecordingEnd Recorder::run(const std::function<bool()>& stop_requested,
                           const std::function<void(const RecordingProgress&)>& after_volume) {
  return impl_->run(stop_requested, after_volume);
}

const RecordingProgress& Recorder::progress() const {
  return impl_->progress();
}

RecordingEnd Recorder::Impl::run(
    const std::function<bool()>& stop_requested,
    const std::function<void(const RecordingProgress&)>& after_volume) {
  const RecordingEnd end = read_link(stop_requested, after_volume);
  // A damaged length may hide whole packets that are there.
  if (end == RecordingEnd::stop_requested) static_cast<void>(audit_chunk({}, true));
  return end;
}

RecordingEnd Recorder::Impl::read_link(
    const std::function<bool()>& stop_requested,
    const std::function<void(const RecordingProgress&)>& after_volume) {
  std::vector<std::byte> chunk(kChunkBytes);
  for (;;) {
    if (stop_requested()) return RecordingEnd::stop_requested;
    const ReadResult result = link_.read(chunk, HostClock::now() + kStopPollInterval);
    const auto received = std::span(chunk).first(result.bytes);
    const std::uint64_t volumes = progress_.volumes;
    const bool over =
        result.status == ReadStatus::end_of_stream || result.status == ReadStatus::lost;
    const std::size_t recorded = audit_chunk(received, over);
    sink_(received.first(recorded));
    progress_.bytes += recorded;
    if (after_volume && progress_.volumes > volumes) after_volume(progress_);
    if (unreadable_) std::rethrow_exception(unreadable_);
    if (has_all_volumes()) return RecordingEnd::volumes;
    if (result.status == ReadStatus::end_of_stream) return RecordingEnd::end_of_stream;
    if (result.status == ReadStatus::lost) return RecordingEnd::lost;
    if (result.status == ReadStatus::cancelled) return RecordingEnd::stop_requested;
  }
}

std::size_t Recorder::Impl::audit_chunk(std::span<const std::byte> chunk, bool last) {
  framer_.feed(chunk);
  if (last) framer_.finish();
  const std::uint64_t before = std::exchange(fed_, fed_ + chunk.size());
  std::uint64_t end = fed_;
  try {
    while (audit_next()) {
    }
    check_skipped(framer_.skipped_in_a_row(), framer_.wrong_checksums());
    if (has_all_volumes()) end = packet_end_;
  } catch (const UnreadableStream&) {
    unreadable_ = std::current_exception();
    end = packet_offset_;
  }
  if (!has_all_volumes()) progress_.damage = framer_.damage();
  return static_cast<std::size_t>(std::max(end, before) - before);
}

bool Recorder::Impl::audit_next() {
  const auto frame = framer_.next();
  if (!frame) return false;
  packet_offset_ = frame->offset;
  packet_end_ = frame->offset + frame->bytes.size();
  if (packet_version(frame->bytes) != kWireVersion) {
    throw UnsupportedWireVersion(packet_version(frame->bytes));
  }
  const auto packet = is_known_kind(frame->bytes) ? parse_packet(frame->bytes) : std::nullopt;
  if (!packet && is_known_kind(frame->bytes)) {
    framer_.reject_last();
    return true;
  }
  const bool ends_volume = packet && audit_packet(*packet);
  progress_.whole_bytes = packet_end_;
  if (!ends_volume) return true;
  ++progress_.volumes;
  return !has_all_volumes();
}

bool Recorder::Impl::audit_packet(const Packet& packet) {
  if (framer_.damage().regions != progress_.damage.regions) audit_.note_damage();
  progress_.damage = framer_.damage();
  const bool ends_volume = std::visit(
      [this](const auto& kind) {
        using Kind = std::decay_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, StickPacket>) {
          if (audit_.take(kind.stick).accepted) audit_.deliver();
          return false;
        } else {
          constexpr bool kEnds = std::is_same_v<Kind, VolumeEndPacket>;
          const bool accepted = audit_.take(kind).accepted;
          if (accepted && !kEnds) ++progress_.acquisitions;
          return accepted && kEnds;
        }
      },
      packet);
  progress_.account = audit_.account();
  progress_.next_sequence = audit_.next_sequence();
  progress_.configuration = audit_.configuration();
  return ends_volume;
}

}  // namespace wobblebench::hw
