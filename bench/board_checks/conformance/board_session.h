// A board over a newly opened link, and the events that a check receives from it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/board_checks/conformance/suite.h"

namespace wobblebench::bench {

/// Longer than the pauses of any source; only a faulty one is waited for so long.
inline constexpr auto kEventTimeout = std::chrono::seconds(20);

inline hw::HostTime event_deadline() {
  return hw::HostClock::now() + kEventTimeout;
}

/// FNV-1a over sequence, time and the samples' bits.
std::uint64_t fingerprint(const hw::Stick& stick);

struct ReceivedStick {
  std::uint64_t sequence = 0;
  hw::StickIndex index;
  hw::DeviceTime time{};
  std::size_t samples = 0;
  std::uint64_t fingerprint = 0;
};

struct Received {
  std::vector<ReceivedStick> sticks;
  std::vector<hw::Gap> gaps;
  std::vector<hw::VolumeEnd> ends;
  std::vector<hw::Configuration> configurations;
  /// Runs of sequence numbers of sticks and gaps, in the order of the events.
  struct Run {
    std::uint64_t first, count;
  };
  std::vector<Run> order;
  bool over = false;       ///< the stream has ended
  bool lost = false;       ///< … because the device is lost
  std::string end_reason;  ///< for messages
};

class BoardSession {
 public:
  explicit BoardSession(const ConformanceFixture& fixture, int ring_slots = 4096);

  /// Adds events to `received` until it holds `sticks` of them, or the stream has ended. Throws
  /// CheckFailed if there was no event for kEventTimeout.
  void receive(Received& received, std::size_t sticks);
  /// The next `sticks`; throws CheckSkipped if the stream ends before.
  Received receive_all(std::size_t sticks);
  /// The next slot; throws as receive_all(). All events until then are added to `received`.
  hw::StickSlot receive_slot(Received& received);
  hw::StickSlot receive_slot();

  BoardInterface board;

 private:
  std::unique_ptr<hw::Board> owned_;
};

/// Adds one event; false if no more will come for now.
[[nodiscard]] bool record_event(hw::Event& event, Received& received);

/// Requires that the call throws IllegalBoardCall and leaves the state as it was.
void require_illegal(const BoardInterface& board,
                     const std::string& what,
                     const std::function<void()>& call);

}  // namespace wobblebench::bench
