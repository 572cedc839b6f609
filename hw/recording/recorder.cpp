#include "hw/recording/recorder.h"

#include <algorithm>
#include <chrono>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/options.h"

namespace wobblebench::hw {
namespace {

constexpr std::size_t kChunkBytes = 65536;
constexpr auto kBetweenQuestions = std::chrono::milliseconds(100);

}  // namespace

Recorder::Recorder(Link& link, Sink sink, const RecorderOptions& options)
    : link_(link), sink_(std::move(sink)), options_(options) {
  check_options(options);
}

RecordingEnd Recorder::run(const std::function<bool()>& asked,
                           const std::function<void(const RecordingProgress&)>& after_volume) {
  std::vector<std::byte> chunk(kChunkBytes);
  for (;;) {
    if (asked()) return RecordingEnd::asked;
    const ReadResult result = link_.read(chunk, HostClock::now() + kBetweenQuestions);
    const auto came = std::span(chunk).first(result.bytes);
    const std::uint64_t volumes = progress_.volumes;
    const std::size_t ours = audit(came);
    sink_(came.first(ours));
    progress_.bytes += ours;
    if (after_volume && progress_.volumes > volumes) after_volume(progress_);
    if (options_.volumes > 0 && progress_.volumes >= static_cast<std::uint64_t>(options_.volumes)) {
      return RecordingEnd::volumes;
    }
    if (result.status == ReadStatus::end_of_stream) return RecordingEnd::end_of_stream;
    if (result.status == ReadStatus::lost) return RecordingEnd::lost;
    if (result.status == ReadStatus::cancelled) return RecordingEnd::asked;
  }
}

std::size_t Recorder::audit(std::span<const std::byte> chunk) {
  framer_.feed(chunk);
  const std::uint64_t before = std::exchange(fed_, fed_ + chunk.size());
  while (const auto frame = framer_.next()) {
    if (packet_version(frame->bytes) != kWireVersion) {
      throw UnsupportedWireVersion(packet_version(frame->bytes));
    }
    const auto packet = is_known_kind(frame->bytes) ? parse_packet(frame->bytes) : std::nullopt;
    if (!packet) {
      if (is_known_kind(frame->bytes)) framer_.refuse();
      continue;
    }
    if (framer_.damage().places != progress_.damage.places) audit_.note_damage();
    progress_.damage = framer_.damage();
    const bool ends_volume = std::visit(
        [this](const auto& kind) {
          using Kind = std::decay_t<decltype(kind)>;
          if constexpr (std::is_same_v<Kind, StickPacket>) {
            if (audit_.take(kind.stick).accepted) audit_.deliver();
            return false;
          } else {
            return audit_.take(kind).accepted && std::is_same_v<Kind, VolumeEndPacket>;
          }
        },
        *packet);
    progress_.account = audit_.account();
    progress_.configuration = audit_.configuration();
    if (!ends_volume) continue;
    ++progress_.volumes;
    if (options_.volumes > 0 && progress_.volumes >= static_cast<std::uint64_t>(options_.volumes)) {
      return static_cast<std::size_t>(frame->offset + frame->bytes.size() - before);
    }
  }
  progress_.damage = framer_.damage();
  return chunk.size();
}

}  // namespace wobblebench::hw
