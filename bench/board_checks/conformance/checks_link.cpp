// The contract of the link, below the board.
#include <algorithm>
#include <atomic>
#include <thread>

#include "bench/board_checks/conformance/board_session.h"
#include "bench/board_checks/conformance/suite.h"
#include "hw/wire/decoder.h"

namespace wobblebench::bench {

namespace {

using std::chrono::milliseconds;

constexpr std::size_t kBytes = 200000;

/// One read, with bytes and status checked against each other.
hw::ReadResult checked_read(hw::Link& link, std::span<std::byte> buffer) {
  const hw::ReadResult result = link.read(buffer, event_deadline());
  require((result.bytes > 0) == (result.status == hw::ReadStatus::ok),
          "a read gives " + std::to_string(result.bytes) + " bytes with a status that contradicts");
  require(result.bytes <= buffer.size(), "a read gives more than was asked for");
  require(result.status != hw::ReadStatus::timeout, "a read gave up before its deadline");
  return result;
}

/// The first bytes of the stream, read in pieces of at most `piece`.
std::vector<std::byte> first_bytes(hw::Link& link, std::size_t piece) {
  std::vector<std::byte> bytes, buffer(piece);
  while (bytes.size() < kBytes) {
    const hw::ReadResult result =
        checked_read(link, std::span(buffer).first(std::min(piece, kBytes - bytes.size())));
    if (result.status != hw::ReadStatus::ok) break;
    bytes.insert(
        bytes.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(result.bytes));
  }
  return bytes;
}

std::string reads(const ConformanceFixture& fixture) {
  auto link = fixture.open();
  const auto whole = first_bytes(*link, 65536);
  link.reset();
  if (!fixture.repeatable) return std::to_string(whole.size()) + " bytes read";
  const auto again = fixture.open();
  const auto pieces = first_bytes(*again, 97);
  require(whole == pieces, "the stream depends on how it is read");
  return std::to_string(whole.size()) + " bytes, the same in pieces of 65 536 and of 97";
}

std::string polls(const ConformanceFixture& fixture) {
  const auto link = fixture.open();
  std::vector<std::byte> buffer(4096);
  const auto start = hw::HostClock::now();
  for (int i = 0; i < 100; ++i) static_cast<void>(link->read(buffer, hw::HostTime::min()));
  const auto ms = std::chrono::duration_cast<milliseconds>(hw::HostClock::now() - start).count();
  // A volume may be simulated in between: the bound is on the sum.
  require(ms < 5000, "100 polls took " + std::to_string(ms) + " ms");
  return "100 polls did not wait";
}

/// Twice: the second of two calls of cancel() may come after a reader has woken from the first.
void require_cancelled(hw::Link& link, std::span<std::byte> buffer) {
  for (int read = 0; read < 2; ++read) {
    require(link.read(buffer, event_deadline()).status == hw::ReadStatus::cancelled,
            "cancel() wears off before resume()");
  }
}

/// A link is cancelled before its first read, which no busy machine delays beyond the end of the
/// stream. Then a reading thread is cancelled at many moments, and on a busy machine until it has
/// read something; no byte is lost.
std::string cancelled_reads(const ConformanceFixture& fixture) {
  const auto link = fixture.open();
  hw::Decoder decoder;
  std::vector<std::byte> buffer(997);
  link->cancel();
  require_cancelled(*link, buffer);
  link->resume();
  std::uint64_t bytes = 0;
  bool ended = false;
  int cancels = 0;
  const auto nothing_to_read = [&, give_up = event_deadline()] {
    return bytes == 0 && hw::HostClock::now() < give_up;
  };
  for (; (cancels < 20 || nothing_to_read()) && !ended; ++cancels) {
    hw::ReadResult last;
    std::jthread reader([&] {
      do {
        last = link->read(buffer, event_deadline());
        decoder.feed(std::span(buffer).first(last.bytes));
        while (decoder.next()) {
        }
        bytes += last.bytes;
      } while (last.status == hw::ReadStatus::ok);
    });
    std::this_thread::sleep_for(milliseconds(1 + cancels % 3));
    link->cancel();
    link->cancel();
    reader.join();
    ended = last.status == hw::ReadStatus::end_of_stream || last.status == hw::ReadStatus::lost;
    require(ended || last.status == hw::ReadStatus::cancelled, "a cancelled read does not say so");
    if (ended) break;
    require_cancelled(*link, buffer);
    link->resume();
  }
  require(fixture.faulty || decoder.damage().regions == 0, "cancelling damaged the stream");
  if (bytes == 0) throw CheckSkipped("nothing was read");
  return std::to_string(bytes) + " bytes read over " + std::to_string(cancels) + " cancels";
}

std::string closed(const ConformanceFixture& fixture) {
  const auto link = fixture.open();
  std::vector<std::byte> buffer(4096);
  static_cast<void>(link->read(buffer, event_deadline()));
  link->close();
  link->close();
  for (int i = 0; i < 3; ++i) {
    require(link->read(buffer, event_deadline()).status == hw::ReadStatus::lost,
            "a closed link gives bytes");
  }
  return "reads after close() give lost";
}

std::string reopens(const ConformanceFixture& fixture) {
  for (int i = 0; i < 5; ++i) {
    std::unique_ptr<hw::Link> link;
    try {
      link = fixture.open();
    } catch (const std::exception& error) {
      throw CheckFailed("opening number " + std::to_string(i + 1) + ": " + error.what());
    }
    std::vector<std::byte> buffer(4096);
    const hw::ReadResult result = link->read(buffer, event_deadline());
    require(result.status == hw::ReadStatus::ok || fixture.faulty, "it opens and gives nothing");
    link->close();
  }
  return "opened and closed 5 times, each time with bytes";
}

std::string capabilities(const ConformanceFixture& fixture) {
  const auto link = fixture.open();
  const hw::LinkCapabilities said = link->capabilities();
  const auto source = static_cast<std::uint32_t>(said.origin);
  require(source >= 1 && source <= 4, "provenance " + std::to_string(source));
  require((said.buffers > 0) == (said.buffer_bytes > 0), "buffers without bytes, or bytes without");
  require((said.buffers > 0) == (said.buffers_per_interrupt > 0), "buffers and no interrupt");
  require(said.buffers_per_interrupt <= said.buffers, "more buffers an interrupt than buffers");
  link->close();
  const hw::LinkCapabilities later = link->capabilities();
  require(later.origin == said.origin && later.waits_for_reader == said.waits_for_reader &&
              later.buffers == said.buffers,
          "capabilities change");
  return std::string(hw::to_string(said.origin)) + ", " +
         (said.copy_in ? "copies in" : "zero copy") + ", " +
         (said.waits_for_reader ? "waits for its reader" : "keeps its pace");
}

}  // namespace

std::vector<ConformanceCheck> link_checks() {
  return {
      {"link.read", "Bytes come exactly with ok, and do not depend on how they are read", reads},
      {"link.poll", "A deadline in the past polls", polls},
      {"link.cancel", "cancel() holds until resume(), and loses no bytes", cancelled_reads},
      {"link.close", "A closed link is lost", closed},
      {"link.reopen", "A closed link can be opened again at once", reopens},
      {"link.capabilities", "Capabilities agree with each other and stay", capabilities},
  };
}

}  // namespace wobblebench::bench
