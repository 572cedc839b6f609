// Any bytes, in any pieces, through decoder and board: no crash, no unbalanced account, and the
// same packets whatever the pieces.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "hw/board/board.h"
#include "hw/wire/decoder.h"
#include "tests/fuzz/reseal.h"

namespace hw = wobblebench::hw;

namespace {

using Bytes = std::span<const std::byte>;

/// Lengths of pieces: the first byte of the input seeds them. Short and long ones mixed, so that a
/// piece ends at any byte for some seed, and yet a stream is a few dozen pieces: as many steps of
/// the board as bytes would take most of the time.
class PieceLengths {
 public:
  explicit PieceLengths(std::uint8_t seed) : state_(seed) {}
  std::size_t next() {
    state_ = state_ * 1664525 + 1013904223;
    constexpr std::array<std::size_t, 8> kMost{1, 3, 8, 64, 80, 128, 256, 512};
    return 1 + (state_ >> 16) % kMost[state_ >> 29];
  }

 private:
  std::uint32_t state_;
};

/// All in one piece.
struct Whole {
  std::size_t next() const { return std::numeric_limits<std::size_t>::max(); }
};

class PiecesLink : public hw::Link {
 public:
  PiecesLink(Bytes bytes, PieceLengths lengths) : bytes_(bytes), lengths_(lengths) {}
  hw::ReadResult read(std::span<std::byte> buffer, hw::HostTime) override {
    if (bytes_.empty()) return {0, hw::ReadStatus::end_of_stream};
    const std::size_t count = std::min({lengths_.next(), buffer.size(), bytes_.size()});
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
  PieceLengths lengths_;
};

/// Packets, and bytes that belong to none.
template <class Lengths>
std::pair<std::size_t, std::uint64_t> decode(Bytes bytes, Lengths lengths) {
  hw::Decoder decoder;
  std::size_t packets = 0;
  try {
    while (!bytes.empty()) {
      const auto part = bytes.first(std::min(lengths.next(), bytes.size()));
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

void play(Bytes bytes, PieceLengths lengths) {
  hw::Board board(std::make_unique<PiecesLink>(bytes, lengths),
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
  const PieceLengths lengths(data[0]);
  const Bytes bytes = std::as_bytes(std::span(data + 1, size - 1));
  if (decode(bytes, lengths) != decode(bytes, Whole{})) std::abort();
  play(bytes, lengths);
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                               std::size_t size,
                                               std::size_t max_size,
                                               unsigned seed) {
  return wobblebench::fuzz::mutate_and_seal(data, size, max_size, seed);
}
