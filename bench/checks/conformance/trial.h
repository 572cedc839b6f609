// One board over one freshly opened link, and what a check takes from it.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bench/checks/conformance/fixture.h"

namespace wobblebench::bench {

/// Longer than any source is silent; only a fault waits for it.
inline constexpr auto kTrialPatience = std::chrono::seconds(20);

inline hw::HostTime soon() {
  return hw::HostClock::now() + kTrialPatience;
}

/// FNV-1a over sequence, time and the samples' bits.
std::uint64_t fingerprint(const hw::Stick& stick);

struct TakenStick {
  std::uint64_t sequence = 0;
  hw::StickIndex index;
  hw::DeviceTime time{};
  std::size_t samples = 0;
  std::uint64_t fingerprint = 0;
};

struct Taken {
  std::vector<TakenStick> sticks;
  std::vector<hw::Gap> gaps;
  std::vector<hw::VolumeEnd> ends;
  std::vector<hw::Configuration> configurations;
  /// Runs of sequence numbers in the order of the events: sticks, and gaps.
  struct Run {
    std::uint64_t first, count;
  };
  std::vector<Run> order;
  bool over = false;          ///< the stream said that no more will come
  bool lost = false;          ///< … because the device is gone
  std::string what_ended_it;  ///< for messages
};

class Trial {
 public:
  explicit Trial(const ConformanceFixture& fixture, int ring_slots = 4096);

  /// Takes events into `taken` until it holds `sticks`, or the stream is over, or nothing came for
  /// kTrialPatience. Throws CheckFailed in the last case.
  void take(Taken& taken, std::size_t sticks);
  /// The same; throws CheckSkipped if the stream is over before.
  Taken take_all_of(std::size_t sticks);
  /// The next slot; throws as take_all_of().
  hw::StickSlot take_slot();

  BoardFace board;

 private:
  std::unique_ptr<hw::Board> owned_;
};

/// Adds one event; false if it says that no more will come for now.
bool note(hw::Event& event, Taken& taken);

/// Whether the calls was refused as the contract says: IllegalBoardCall, and the same state after.
void require_illegal(const BoardFace& board,
                     const std::string& what,
                     const std::function<void()>& call);

}  // namespace wobblebench::bench
