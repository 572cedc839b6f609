#include "bench/checks/conformance/trial.h"

#include <bit>
#include <variant>

namespace wobblebench::bench {

namespace {

class Fnv {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ (value >> (8 * byte) & 0xFF)) * 0x100000001B3;
    }
  }
  std::uint64_t hash() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325;
};

}  // namespace

BoardFace face_of(hw::Board& board) {
  return {.start = [&board] { board.start(); },
          .stop = [&board] { board.stop(); },
          .cancel = [&board] { board.cancel(); },
          .close = [&board] { board.close(); },
          .next = [&board](hw::HostTime deadline) { return board.next(deadline); },
          .state = [&board] { return board.state(); },
          .account = [&board] { return board.account(); },
          .free_slots = [&board] { return board.free_slots(); },
          .capabilities = [&board] { return board.capabilities(); }};
}

std::uint64_t fingerprint(const hw::Stick& stick) {
  Fnv hash;
  hash.add(stick.sequence);
  hash.add(static_cast<std::uint64_t>(stick.time.time_since_epoch().count()));
  for (const float sample : stick.samples) hash.add(std::bit_cast<std::uint32_t>(sample));
  return hash.hash();
}

Trial::Trial(const ConformanceFixture& fixture, int ring_slots)
    : owned_(
          std::make_unique<hw::Board>(fixture.open(), hw::BoardOptions{.ring_slots = ring_slots})) {
  board = fixture.face(*owned_);
}

bool note(hw::Event& event, Taken& taken) {
  if (const auto* slot = std::get_if<hw::StickSlot>(&event)) {
    const hw::Stick& stick = **slot;
    taken.sticks.push_back(
        {stick.sequence, stick.index, stick.time, stick.samples.size(), fingerprint(stick)});
    taken.order.push_back({stick.sequence, 1});
    return true;
  }
  if (const auto* gap = std::get_if<hw::Gap>(&event)) {
    taken.gaps.push_back(*gap);
    taken.order.push_back({gap->first_sequence, gap->count});
    return true;
  }
  if (const auto* end = std::get_if<hw::VolumeEnd>(&event)) {
    taken.ends.push_back(*end);
    return true;
  }
  if (const auto* configuration = std::get_if<hw::Configuration>(&event)) {
    taken.configurations.push_back(*configuration);
    return true;
  }
  taken.lost = std::holds_alternative<hw::DeviceLost>(event);
  taken.over = taken.lost || std::holds_alternative<hw::EndOfStream>(event);
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) taken.what_ended_it = lost->reason;
  if (std::holds_alternative<hw::EndOfStream>(event)) taken.what_ended_it = "the stream is over";
  if (std::holds_alternative<hw::TimedOut>(event)) taken.what_ended_it = "nothing came in time";
  if (std::holds_alternative<hw::Cancelled>(event)) taken.what_ended_it = "cancelled";
  if (std::holds_alternative<hw::Stopped>(event)) taken.what_ended_it = "stopped";
  return false;
}

void Trial::take(Taken& taken, std::size_t sticks) {
  while (taken.sticks.size() < sticks) {
    hw::Event event = board.next(soon());
    if (note(event, taken)) continue;
    require(taken.over,
            taken.what_ended_it + " after " + std::to_string(taken.sticks.size()) + " sticks");
    return;
  }
}

Taken Trial::take_all_of(std::size_t sticks) {
  Taken taken;
  take(taken, sticks);
  if (taken.sticks.size() < sticks) {
    throw CheckSkipped("needs " + std::to_string(sticks) + " sticks; " + taken.what_ended_it +
                       " after " + std::to_string(taken.sticks.size()));
  }
  return taken;
}

hw::StickSlot Trial::take_slot() {
  for (;;) {
    hw::Event event = board.next(soon());
    if (auto* slot = std::get_if<hw::StickSlot>(&event)) return std::move(*slot);
    Taken taken;
    if (note(event, taken)) continue;
    require(taken.over, taken.what_ended_it + " where a stick was due");
    throw CheckSkipped("needs a stick; " + taken.what_ended_it);
  }
}

void require_illegal(const BoardFace& board,
                     const std::string& what,
                     const std::function<void()>& call) {
  const hw::BoardState before = board.state();
  bool refused = false;
  try {
    call();
  } catch (const hw::IllegalBoardCall&) {
    refused = true;
  }
  require(refused, what + " is not refused");
  require(board.state() == before, what + " is refused and changes the state");
}

}  // namespace wobblebench::bench
