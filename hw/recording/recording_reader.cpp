#include "hw/recording/recording_reader.h"

namespace wobblebench::hw {

std::optional<PacketFrame> RecordingReader::next_frame() {
  for (;;) {
    if (auto frame = framer_.next()) return frame;
    if (finished_) return {};
    const std::size_t count = file_.read(read_, chunk_);
    read_ += count;
    framer_.feed(std::span(chunk_).first(count));
    finished_ = count < chunk_.size();
    if (finished_) framer_.finish();
  }
}

std::optional<RecordedPacket> RecordingReader::next() {
  while (const auto frame = next_frame()) {
    RecordedPacket recorded{.bytes = frame->bytes, .offset = start_ + frame->offset};
    offset_ = recorded.offset;
    if (packet_version(frame->bytes) != kWireVersion) {
      throw UnsupportedWireVersion(packet_version(frame->bytes));
    }
    if (is_known_kind(frame->bytes)) {
      recorded.packet = parse_packet(frame->bytes);
      if (!recorded.packet) {
        framer_.reject_last();
        continue;
      }
    }
    recorded.damage_before = recorded.offset - end_;
    end_ = recorded.offset + recorded.bytes.size();
    return recorded;
  }
  return {};
}

}  // namespace wobblebench::hw
