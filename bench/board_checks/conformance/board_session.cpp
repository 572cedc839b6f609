#include "bench/board_checks/conformance/board_session.h"

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

BoardInterface interface_of(hw::Board& board) {
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

BoardSession::BoardSession(const ConformanceFixture& fixture, int ring_slots)
    : owned_(
          std::make_unique<hw::Board>(fixture.open(), hw::BoardOptions{.ring_slots = ring_slots})) {
  board = fixture.interface(*owned_);
}

bool record_event(hw::Event& event, Received& received) {
  if (const auto* slot = std::get_if<hw::StickSlot>(&event)) {
    const hw::Stick& stick = **slot;
    received.sticks.push_back(
        {stick.sequence, stick.index, stick.time, stick.samples.size(), fingerprint(stick)});
    received.order.push_back({stick.sequence, 1});
    return true;
  }
  if (const auto* gap = std::get_if<hw::Gap>(&event)) {
    received.gaps.push_back(*gap);
    received.order.push_back({gap->first_sequence, gap->count});
    return true;
  }
  if (const auto* end = std::get_if<hw::VolumeEnd>(&event)) {
    received.ends.push_back(*end);
    return true;
  }
  if (const auto* configuration = std::get_if<hw::Configuration>(&event)) {
    received.configurations.push_back(*configuration);
    return true;
  }
  received.lost = std::holds_alternative<hw::DeviceLost>(event);
  received.over = received.lost || std::holds_alternative<hw::EndOfStream>(event);
  if (const auto* lost = std::get_if<hw::DeviceLost>(&event)) received.end_reason = lost->reason;
  if (std::holds_alternative<hw::EndOfStream>(event)) received.end_reason = "the stream is over";
  if (std::holds_alternative<hw::TimedOut>(event)) received.end_reason = "nothing came in time";
  if (std::holds_alternative<hw::Cancelled>(event)) received.end_reason = "cancelled";
  if (std::holds_alternative<hw::Stopped>(event)) received.end_reason = "stopped";
  return false;
}

void BoardSession::receive(Received& received, std::size_t sticks) {
  while (received.sticks.size() < sticks) {
    hw::Event event = board.next(event_deadline());
    if (record_event(event, received)) continue;
    require(received.over,
            received.end_reason + " after " + std::to_string(received.sticks.size()) + " sticks");
    return;
  }
}

Received BoardSession::receive_all(std::size_t sticks) {
  Received received;
  receive(received, sticks);
  if (received.sticks.size() < sticks) {
    throw CheckSkipped("needs " + std::to_string(sticks) + " sticks; " + received.end_reason +
                       " after " + std::to_string(received.sticks.size()));
  }
  return received;
}

hw::StickSlot BoardSession::receive_slot() {
  Received received;
  return receive_slot(received);
}

hw::StickSlot BoardSession::receive_slot(Received& received) {
  for (;;) {
    hw::Event event = board.next(event_deadline());
    const bool goes_on = record_event(event, received);
    if (auto* slot = std::get_if<hw::StickSlot>(&event)) return std::move(*slot);
    if (goes_on) continue;
    require(received.over, received.end_reason + " where a stick was due");
    throw CheckSkipped("needs a stick; " + received.end_reason);
  }
}

void require_illegal(const BoardInterface& board,
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
