// The board's reader thread: link to decoder to ring, and the account of what went missing.
#include <algorithm>
#include <array>
#include <exception>

#include "hw/board.h"
#include "hw/options.h"

namespace wobblebench::hw {
namespace {

/// A few sticks at a time: large enough to be cheap, small enough not to delay the first of them.
constexpr std::size_t kReadBytes = 65536;
/// How long a read may sleep. A stop does not wait for it: it cancels the read.
constexpr auto kReadPatience = std::chrono::milliseconds(500);
/// Events other than sticks that may wait for the program.
constexpr std::size_t kWaitingNotices = 256;

AcquisitionPlan plan_of(const ConfigurationPacket& packet) {
  try {
    return AcquisitionPlan(packet.probe, packet.acquisition);
  } catch (const InvalidOption& error) {
    throw std::runtime_error(std::string("the device's configuration is not possible: ") +
                             error.what());
  }
}

bool same_plan(const Configuration& configuration, const ConfigurationPacket& packet) {
  return configuration.plan.probe() == packet.probe &&
         configuration.plan.acquisition() == packet.acquisition &&
         configuration.source == packet.source;
}

/// The index lies in the plan, and is the one that the sequence number stands for. The number of
/// volumes is what was asked for; a stream may go on beyond it.
bool index_fits(const AcquisitionPlan& plan, const Stick& stick) {
  return stick.index == plan.index(stick.sequence);
}

}  // namespace

void Board::read_until(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested() && place_decoded(stop) && read_link(stop)) {
    }
  } catch (const std::exception& error) {
    lose_device(error.what());
  }
}

bool Board::read_link(const std::stop_token& stop) {
  std::array<std::byte, kReadBytes> buffer;
  const ReadResult result = link_->read(buffer, HostClock::now() + kReadPatience);
  decoder_.feed(std::span(buffer).first(result.bytes));
  switch (result.status) {
    case ReadStatus::ok:
    case ReadStatus::timeout:
      return true;
    case ReadStatus::cancelled:
      return false;
    case ReadStatus::lost:
      lose_device("the device is gone");
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
    {
      std::lock_guard lock(mutex_);
      after_damage_ = after_damage_ || decoder_.damage().places != damage_.places;
      damage_ = decoder_.damage();
    }
    if (!unplaced_) return true;
    if (!std::visit([&](auto& packet) { return place(packet, stop); }, *unplaced_)) return false;
    unplaced_.reset();
  }
}

bool Board::place(const ConfigurationPacket& packet, const std::stop_token& stop) {
  Configuration configuration{plan_of(packet), packet.source};
  if (!wait_for_queue(stop)) return false;
  std::lock_guard lock(mutex_);
  const bool repeated = configuration_ && same_plan(*configuration_, packet);
  if (configuration_ && !repeated) ledger_.restart();
  advance_to(packet.sequence);
  if (repeated) return true;
  configuration_ = configuration;
  push(configuration);
  return true;
}

bool Board::place(StickPacket& packet, const std::stop_token& stop) {
  if (!wait_for_queue(stop)) return false;
  {
    std::lock_guard lock(mutex_);
    if (!awaits(packet.stick)) return true;
  }
  Stick* slot = waits_for_reader_ ? ring_->wait(stop) : ring_->acquire();
  if (slot == nullptr && waits_for_reader_) return false;
  std::lock_guard lock(mutex_);
  if (slot != nullptr && queue_is_full()) {
    ring_->release(slot);
    slot = nullptr;
  }
  if (slot == nullptr) {
    report(ledger_.lose(LossCause::ring_full));
    return true;
  }
  *slot = std::move(packet.stick);
  ledger_.deliver();
  push(StickSlot(ring_, slot));
  return true;
}

bool Board::place(const VolumeEndPacket& packet, const std::stop_token& stop) {
  if (!wait_for_queue(stop)) return false;
  std::lock_guard lock(mutex_);
  if (configuration_ &&
      packet.sequence != configuration_->plan.first_sequence(packet.volume) +
                             static_cast<std::uint64_t>(configuration_->plan.sticks_per_volume())) {
    after_damage_ = true;
    return true;
  }
  advance_to(packet.sequence);
  // Late or repeated: the volume it ends is over.
  if (!inside_volume_ || ledger_.next() != packet.sequence) return true;
  inside_volume_ = false;
  if (!queue_is_full()) push(VolumeEnd{packet.volume, packet.time});
  return true;
}

/// True if this is the stick that comes next and can be delivered; else it is accounted for.
bool Board::awaits(const Stick& stick) {
  if (configuration_ && !index_fits(configuration_->plan, stick)) {
    // Its sequence number may be what is wrong. What follows shows which stick is missing.
    after_damage_ = true;
    return false;
  }
  const bool damaged = after_damage_;
  advance_to(stick.sequence);
  if (!ledger_.expects(stick.sequence)) return false;
  inside_volume_ = true;
  if (!configuration_) {
    report(ledger_.lose(damaged ? LossCause::corrupt : LossCause::link));
    return false;
  }
  const auto samples =
      static_cast<std::size_t>(configuration_->plan.acquisition().samples_per_stick);
  if (stick.samples.size() == samples) return true;
  report(ledger_.lose(LossCause::corrupt));
  return false;
}

void Board::advance_to(std::uint64_t sequence) {
  if (const std::optional<Gap> gap = ledger_.advance_to(sequence, after_damage_)) {
    inside_volume_ = true;
    report(*gap);
  }
  if (ledger_.next() == sequence) after_damage_ = false;
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
  changed_.notify_all();
}

void Board::push(Notice notice) {
  if (open_gap_) queue_.emplace_back(*std::exchange(open_gap_, std::nullopt));
  queue_.push_back(std::move(notice));
  changed_.notify_all();
}

bool Board::queue_is_full() const {
  return queue_.size() >= static_cast<std::size_t>(ring_->slots()) + kWaitingNotices;
}

bool Board::wait_for_queue(const std::stop_token& stop) {
  if (!waits_for_reader_) return true;
  std::unique_lock lock(mutex_);
  return changed_.wait(lock, stop, [this] { return !queue_is_full(); });
}

void Board::end_stream() {
  std::lock_guard lock(mutex_);
  ending_ = Ending::end_of_stream;
  end_of_stream_.truncated = cut_packet_ || inside_volume_;
  changed_.notify_all();
}

void Board::lose_device(const std::string& reason) {
  std::lock_guard lock(mutex_);
  ending_ = Ending::lost;
  lost_reason_ = reason;
  state_ = BoardState::lost;
  changed_.notify_all();
}

}  // namespace wobblebench::hw
