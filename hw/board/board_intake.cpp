// The board's reader thread: link to decoder to ring, and the account of what went missing.
#include <algorithm>
#include <exception>

#include "base/options.h"
#include "hw/board/board.h"

namespace wobblebench::hw {
namespace {

/// A few sticks at a time: large enough to be cheap, small enough not to delay the first of them.
constexpr std::size_t kReadBytes = 65536;
/// How long a read may sleep. A stop does not wait for it: it cancels the read.
constexpr auto kReadPatience = std::chrono::milliseconds(500);
/// Events other than sticks that may wait for the program.
constexpr std::size_t kWaitingNotices = 256;

}  // namespace

void Board::read_until(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested() && place_decoded(stop) &&
           read_link(stop, HostClock::now() + kReadPatience)) {
    }
  } catch (const std::exception& error) {
    lose_device(LossOfDevice::unreadable, error.what());
  }
}

bool Board::step() {
  std::lock_guard control(control_);
  if (reader_mode_ != ReaderMode::stepped) {
    throw IllegalBoardCall("step: the board reads on a thread of its own");
  }
  if (state() != BoardState::running) throw IllegalBoardCall("step: the board is not running");
  if (ending() != Ending::none) return false;
  // A stop already asked for: whatever would wait breaks off instead.
  std::stop_source now;
  now.request_stop();
  stepped_on_ = false;
  try {
    if (place_decoded(now.get_token())) read_link(now.get_token(), HostTime::min());
  } catch (const std::exception& error) {
    lose_device(LossOfDevice::unreadable, error.what());
  }
  return stepped_on_ || ending() != Ending::none;
}

bool Board::read_link(const std::stop_token& stop, HostTime deadline) {
  incoming_.resize(kReadBytes);
  const ReadResult result = link_->read(incoming_, deadline);
  stepped_on_ = stepped_on_ || result.bytes > 0;
  decoder_.feed(std::span(incoming_).first(result.bytes));
  switch (result.status) {
    case ReadStatus::ok:
    case ReadStatus::timeout:
      return true;
    case ReadStatus::cancelled:
      return false;
    case ReadStatus::lost:
      lose_device(LossOfDevice::unplugged, link_->loss());
      return false;
    case ReadStatus::end_of_stream:
      break;
  }
  cut_packet_ = cut_packet_ || decoder_.pending_bytes() > 0;
  decoder_.finish();
  if (place_decoded(stop)) end_stream();
  return false;
}

bool Board::place_decoded(const std::stop_token& stop) {
  for (;;) {
    if (!unplaced_) unplaced_ = decoder_.next();
    note_damage();
    const bool placed =
        !unplaced_ || std::visit([&](auto& packet) { return place(packet, stop); }, *unplaced_);
    if (!unplaced_ || !placed) {
      announce();
      return placed;
    }
    unplaced_.reset();
    stepped_on_ = true;
  }
}

void Board::note_damage() {
  const WireDamage& damage = decoder_.damage();
  if (damage.bytes_skipped == noted_damage_.bytes_skipped) return;
  std::lock_guard lock(mutex_);
  if (damage.places != noted_damage_.places) audit_.note_damage();
  damage_ = noted_damage_ = damage;
}

bool Board::place(const ConfigurationPacket& packet, const std::stop_token& stop) {
  const auto lock = lock_with_room(stop);
  if (!lock) return false;
  const Audited audited = audit_.take(packet);
  report(audited);
  if (audited.accepted) push(*audit_.configuration());
  return true;
}

bool Board::place(StickPacket& packet, const std::stop_token& stop) {
  // Before the audit, which counts a stick only once.
  Stick* slot = waits_for_reader_ ? wait_for_slot(stop) : nullptr;
  if (waits_for_reader_ && slot == nullptr) return false;
  const auto lock = lock_with_room(stop);
  if (!lock) {
    ring_->release(slot);
    return false;
  }
  const Audited audited = audit_.take(packet.stick);
  report(audited);
  if (audited.accepted && slot == nullptr && !queue_is_full()) slot = ring_->acquire();
  if (!audited.accepted) {
    if (slot != nullptr) ring_->release(slot);
  } else if (slot == nullptr) {
    report(audit_.lose(LossCause::ring_full));
  } else {
    std::swap(*slot, packet.stick);
    audit_.deliver();
    push(StickSlot(ring_, slot));
  }
  return true;
}

bool Board::place(const VolumeEndPacket& packet, const std::stop_token& stop) {
  const auto lock = lock_with_room(stop);
  if (!lock) return false;
  const Audited audited = audit_.take(packet);
  report(audited);
  if (audited.accepted && !queue_is_full()) push(VolumeEnd{packet.volume, packet.time});
  return true;
}

void Board::report(const Audited& audited) {
  if (audited.missing) report(*audited.missing);
  if (audited.refused) report(*audited.refused);
}

/// Joins runs of loss of one cause. While the queue is full the program takes nothing, and causes
/// are joined too (the account keeps them apart), so that the queue stays bounded.
void Board::report(const Gap& gap) {
  if (open_gap_ && open_gap_->first_sequence + open_gap_->count == gap.first_sequence &&
      (open_gap_->cause == gap.cause || queue_is_full())) {
    if (open_gap_->cause != gap.cause) open_gap_->cause = LossCause::ring_full;
    open_gap_->count += gap.count;
  } else {
    if (open_gap_) queue_.emplace_back(*open_gap_);
    open_gap_ = gap;
  }
  unannounced_ = true;
}

void Board::push(Notice notice) {
  if (open_gap_) queue_.emplace_back(*std::exchange(open_gap_, std::nullopt));
  queue_.push_back(std::move(notice));
  unannounced_ = true;
}

bool Board::queue_is_full() const {
  return queue_.size() >= static_cast<std::size_t>(ring_->slots()) + kWaitingNotices;
}

/// Where the link waits for its reader, waits for room in the queue; none where a stop breaks off.
std::optional<std::unique_lock<std::mutex>> Board::lock_with_room(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (waits_for_reader_ && queue_is_full()) {
    changed_.notify_all();
    unannounced_ = false;
    if (!changed_.wait(lock, stop, [this] { return !queue_is_full(); })) return {};
  }
  return lock;
}

Stick* Board::wait_for_slot(const std::stop_token& stop) {
  Stick* slot = ring_->acquire();
  if (slot != nullptr) return slot;
  announce();
  return ring_->wait(stop);
}

/// Wakes the program once for all that was placed since the last time: a wake-up for each stick
/// would cost more than the stick.
void Board::announce() {
  if (std::exchange(unannounced_, false)) changed_.notify_all();
}

Board::Ending Board::ending() const {
  std::lock_guard lock(mutex_);
  return ending_;
}

void Board::end_stream() {
  std::lock_guard lock(mutex_);
  ending_ = Ending::end_of_stream;
  end_of_stream_.truncated = cut_packet_ || audit_.inside_volume();
  changed_.notify_all();
}

void Board::lose_device(LossOfDevice cause, const std::string& reason) {
  std::lock_guard lock(mutex_);
  ending_ = Ending::lost;
  loss_ = {cause, reason};
  state_ = BoardState::lost;
  changed_.notify_all();
}

}  // namespace wobblebench::hw
