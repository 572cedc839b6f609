// The board's reader thread: link to decoder to queue, and the counts of losses.
#include <chrono>
#include <exception>

#include "hw/board/board_impl.h"

namespace wobblebench::hw {
namespace {

/// About 30 sticks of the paper: few calls, little delay of the first stick.
constexpr std::size_t kReadBytes = 65536;
/// Longest wait of a read. A stop cancels the read and does not wait for it.
constexpr auto kReadTimeout = std::chrono::milliseconds(500);
/// Queued events other than sticks.
constexpr std::size_t kQueuedOtherEvents = 256;

}  // namespace

void Board::Impl::read_until(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested() && enqueue_decoded(stop) &&
           read_link(stop, HostClock::now() + kReadTimeout)) {
    }
  } catch (const std::exception& error) {
    lose_device(DeviceLossCause::unreadable, error.what());
  }
}

bool Board::Impl::step() {
  std::lock_guard control(control_);
  if (reader_mode_ != ReaderMode::stepped) {
    throw IllegalBoardCall("step: the board reads on a thread of its own");
  }
  if (state() != BoardState::running) throw IllegalBoardCall("step: the board is not running");
  if (ending() != Ending::none) return false;
  // With a stop requested beforehand, nothing below waits.
  std::stop_source no_wait;
  no_wait.request_stop();
  progressed_ = false;
  try {
    if (enqueue_decoded(no_wait.get_token())) read_link(no_wait.get_token(), HostTime::min());
  } catch (const std::exception& error) {
    lose_device(DeviceLossCause::unreadable, error.what());
  }
  return progressed_ || ending() != Ending::none;
}

bool Board::Impl::read_link(const std::stop_token& stop, HostTime deadline) {
  incoming_.resize(kReadBytes);
  const ReadResult result = link_->read(incoming_, deadline);
  progressed_ = progressed_ || result.bytes > 0;
  if (result.bytes > 0) received_ = HostClock::now();
  decoder_.feed(std::span(incoming_).first(result.bytes));
  switch (result.status) {
    case ReadStatus::ok:
    case ReadStatus::timeout:
      return true;
    case ReadStatus::cancelled:
      return false;
    case ReadStatus::lost:
      lose_device(DeviceLossCause::unplugged, link_->loss());
      return false;
    case ReadStatus::end_of_stream:
      break;
  }
  packet_was_cut_ = packet_was_cut_ || decoder_.pending_bytes() > 0;
  decoder_.finish();
  if (enqueue_decoded(stop)) end_stream();
  return false;
}

bool Board::Impl::enqueue_decoded(const std::stop_token& stop) {
  for (;;) {
    if (!pending_) pending_ = decoder_.next();
    update_damage();
    check_skipped(decoder_.skipped_in_a_row(), decoder_.wrong_checksums());
    const bool enqueued =
        !pending_ || std::visit([&](auto& packet) { return enqueue(packet, stop); }, *pending_);
    if (!pending_ || !enqueued) {
      notify_program();
      return enqueued;
    }
    pending_.reset();
    progressed_ = true;
  }
}

void Board::Impl::update_damage() {
  const WireDamage& damage = decoder_.damage();
  if (damage.bytes_skipped == known_damage_.bytes_skipped) return;
  std::lock_guard lock(mutex_);
  if (damage.regions != known_damage_.regions) audit_.note_damage();
  damage_ = known_damage_ = damage;
}

bool Board::Impl::enqueue(const ConfigurationPacket& packet, const std::stop_token& stop) {
  const auto lock = lock_with_room(stop);
  if (!lock) return false;
  const AuditResult result = audit_.take(packet);
  report(result);
  if (result.accepted) push(*audit_.configuration());
  return true;
}

bool Board::Impl::enqueue(StickPacket& packet, const std::stop_token& stop) {
  // Before the audit, as a stick may be counted only once.
  Stick* slot = waits_for_reader_ ? wait_for_slot(stop) : nullptr;
  if (waits_for_reader_ && slot == nullptr) return false;
  const auto lock = lock_with_room(stop);
  if (!lock) {
    ring_->release(slot);
    return false;
  }
  const AuditResult result = audit_.take(packet.stick);
  report(result);
  if (result.accepted && slot == nullptr && !queue_is_full()) slot = ring_->acquire();
  if (!result.accepted) {
    if (slot != nullptr) ring_->release(slot);
  } else if (slot == nullptr) {
    report(audit_.lose(LossCause::ring_full));
  } else {
    std::swap(*slot, packet.stick);
    audit_.deliver();
    push(StickSlot(ring_, slot, received_));
  }
  return true;
}

bool Board::Impl::enqueue(const VolumeEndPacket& packet, const std::stop_token& stop) {
  const auto lock = lock_with_room(stop);
  if (!lock) return false;
  const AuditResult result = audit_.take(packet);
  report(result);
  if (result.accepted && !queue_is_full()) push(VolumeEnd{packet.volume, packet.time});
  return true;
}

void Board::Impl::report(const AuditResult& result) {
  if (result.missing) report(*result.missing);
  if (result.rejected) report(*result.rejected);
}

/// Merges adjacent gaps of one cause. While the queue is full, gaps of different causes are merged
/// too (the account keeps them apart), so that the queue stays bounded.
void Board::Impl::report(const Gap& gap) {
  if (open_gap_ && open_gap_->first_sequence + open_gap_->count == gap.first_sequence &&
      (open_gap_->cause == gap.cause || queue_is_full())) {
    if (open_gap_->cause != gap.cause) open_gap_->cause = LossCause::ring_full;
    open_gap_->count += gap.count;
  } else {
    if (open_gap_) queue_.emplace_back(*open_gap_);
    open_gap_ = gap;
  }
  unnotified_ = true;
}

void Board::Impl::push(QueuedEvent event) {
  if (open_gap_) queue_.emplace_back(*std::exchange(open_gap_, std::nullopt));
  queue_.push_back(std::move(event));
  unnotified_ = true;
}

bool Board::Impl::queue_is_full() const {
  return queue_.size() >= static_cast<std::size_t>(ring_->slots()) + kQueuedOtherEvents;
}

/// Where the link waits for its reader, waits for room in the queue; none after a stop.
std::optional<std::unique_lock<std::mutex>> Board::Impl::lock_with_room(
    const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (waits_for_reader_ && queue_is_full()) {
    changed_.notify_all();
    unnotified_ = false;
    if (!changed_.wait(lock, stop, [this] { return !queue_is_full(); })) return {};
  }
  return lock;
}

Stick* Board::Impl::wait_for_slot(const std::stop_token& stop) {
  Stick* slot = ring_->acquire();
  if (slot != nullptr) return slot;
  notify_program();
  return ring_->wait(stop);
}

/// Wakes the program once for all events since the last time: one wake-up per stick would cost more
/// than the stick.
void Board::Impl::notify_program() {
  if (std::exchange(unnotified_, false)) changed_.notify_all();
}

Board::Impl::Ending Board::Impl::ending() const {
  std::lock_guard lock(mutex_);
  return ending_;
}

void Board::Impl::end_stream() {
  std::lock_guard lock(mutex_);
  ending_ = Ending::end_of_stream;
  end_of_stream_.truncated = packet_was_cut_ || audit_.inside_volume();
  changed_.notify_all();
}

void Board::Impl::lose_device(DeviceLossCause cause, const std::string& reason) {
  std::lock_guard lock(mutex_);
  ending_ = Ending::lost;
  loss_ = {cause, reason};
  state_ = BoardState::lost;
  changed_.notify_all();
}

}  // namespace wobblebench::hw
