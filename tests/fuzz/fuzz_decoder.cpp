// Any bytes, in any pieces, through decoder and board: no crash, no unbalanced account, and the
// same packets whatever the pieces.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "hw/board.h"
#include "hw/decoder.h"
#include "reseal.h"

namespace hw = wobblebench::hw;

namespace {

using Bytes = std::span<const std::byte>;

/// The first byte of the input says how long pieces are; the rest is the stream.
class PiecesLink : public hw::Link {
 public:
  PiecesLink(Bytes bytes, std::size_t piece) : bytes_(bytes), piece_(piece) {}
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime) override {
    if (bytes_.empty()) return {0, hw::ReadStatus::end_of_stream};
    const std::size_t count = std::min({piece_, buffer.size(), bytes_.size()});
    std::copy_n(bytes_.begin(), count, buffer.begin());
    bytes_ = bytes_.subspan(count);
    return {count, hw::ReadStatus::ok};
  }
  void cancel() override {}
  void resume() override {}
  void close() override {}
  hw::LinkCapabilities capabilities() const override { return {}; }

 private:
  Bytes bytes_;
  std::size_t piece_;
};

/// Packets, and bytes that belong to none.
std::pair<std::size_t, std::uint64_t> decode(Bytes bytes, std::size_t piece) {
  hw::Decoder decoder;
  std::size_t packets = 0;
  try {
    while (!bytes.empty()) {
      const auto part = bytes.first(std::min(piece, bytes.size()));
      decoder.feed(part);
      bytes = bytes.subspan(part.size());
      if (bytes.empty()) decoder.finish();
      while (decoder.next()) ++packets;
    }
  } catch (const hw::UnsupportedWireVersion&) {
    return {packets, 0};
  }
  return {packets, decoder.damage().bytes_skipped};
}

void play(Bytes bytes, std::size_t piece) {
  hw::Board board(std::make_unique<PiecesLink>(bytes, piece),
                  {.ring_slots = 4, .reader = hw::ReaderMode::stepped});
  board.start();
  for (;;) {
    const hw::Event event = board.next(hw::HostTime::min());
    if (std::holds_alternative<hw::TimedOut>(event)) {
      board.step();
      continue;
    }
    if (!board.account().balanced()) std::abort();
    if (std::holds_alternative<hw::EndOfStream>(event) ||
        std::holds_alternative<hw::DeviceLost>(event)) {
      return;
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::size_t piece = 1 + data[0];
  const Bytes bytes = std::as_bytes(std::span(data + 1, size - 1));
  if (decode(bytes, piece) != decode(bytes, bytes.size() + 1)) std::abort();
  play(bytes, piece);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                               std::size_t size,
                                               std::size_t max_size,
                                               unsigned seed) {
  return wobblebench::fuzz::mutate_and_seal(data, size, max_size, seed);
}
