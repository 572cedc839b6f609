#include "hw/board/board.h"

#include <stdexcept>
#include <utility>

#include "hw/board/board_impl.h"

namespace wobblebench::hw {

void StickSlot::release() {
  ring_->release(stick_);
}

Board::Board(std::unique_ptr<Link> link, const BoardOptions& options)
    : impl_(std::make_unique<Impl>(std::move(link), options)) {}

Board::~Board() = default;

void Board::start() {
  impl_->start();
}

Event Board::next(HostTime deadline) {
  return impl_->next(deadline);
}

void Board::stop() {
  impl_->stop();
}

void Board::cancel() {
  impl_->cancel();
}

void Board::close() {
  impl_->close();
}

bool Board::step() {
  return impl_->step();
}

BoardState Board::state() const {
  return impl_->state();
}

BoardAccount Board::account() const {
  return impl_->account();
}

WireDamage Board::damage() const {
  return impl_->damage();
}

LinkCapabilities Board::capabilities() const {
  return impl_->capabilities();
}

std::optional<HostTime> Board::epoch() const {
  return impl_->epoch();
}

int Board::ring_slots() const {
  return impl_->ring_slots();
}

int Board::free_slots() const {
  return impl_->free_slots();
}

namespace {

std::unique_ptr<Link> not_null(std::unique_ptr<Link> link) {
  if (link == nullptr) throw std::invalid_argument("a board needs a link");
  return link;
}

}  // namespace

Board::Impl::Impl(std::unique_ptr<Link> link, const BoardOptions& options)
    : link_(not_null(std::move(link))),
      waits_for_reader_(link_->capabilities().waits_for_reader),
      reader_mode_(options.reader),
      ring_(std::make_shared<StickRing>(options.ring_slots)) {}

Board::Impl::~Impl() {
  close();
}

void Board::Impl::start() {
  std::lock_guard control(control_);
  switch (state()) {
    case BoardState::running:
      throw IllegalBoardCall("start: the board is running");
    case BoardState::lost:
      throw IllegalBoardCall("start: the device is lost");
    case BoardState::closed:
      throw IllegalBoardCall("start: the board is closed");
    case BoardState::open:
    case BoardState::configured:
    case BoardState::stopping:
      break;
  }
  join_reader();
  if (state() == BoardState::lost) throw IllegalBoardCall("start: the device is lost");
  std::lock_guard wake(wake_);
  link_->resume();
  stop_ = std::stop_source();
  {
    std::lock_guard lock(mutex_);
    state_ = BoardState::running;
    started_ = true;
    cancelled_ = false;
    ending_ = Ending::none;
  }
  if (reader_mode_ == ReaderMode::stepped) return;
  reader_ = std::jthread([this, stop = stop_.get_token()] { read_until(stop); });
}

void Board::Impl::stop() {
  std::lock_guard control(control_);
  end_reader();
}

void Board::Impl::cancel() {
  std::lock_guard wake(wake_);
  {
    std::lock_guard lock(mutex_);
    cancelled_ = true;
    changed_.notify_all();
  }
  interrupt_reader();
}

void Board::Impl::close() {
  std::lock_guard control(control_);
  end_reader();
  std::lock_guard lock(mutex_);
  if (state_ == BoardState::closed) return;
  link_->close();
  state_ = BoardState::closed;
  changed_.notify_all();
}

void Board::Impl::end_reader() {
  {
    std::lock_guard wake(wake_);
    interrupt_reader();
  }
  join_reader();
}

void Board::Impl::interrupt_reader() {
  {
    std::lock_guard lock(mutex_);
    if (state_ == BoardState::running) state_ = BoardState::stopping;
  }
  stop_.request_stop();
  link_->cancel();
}

void Board::Impl::join_reader() {
  if (reader_.joinable()) reader_.join();
  std::lock_guard lock(mutex_);
  if (state_ != BoardState::stopping) return;
  state_ = audit_.configuration() ? BoardState::configured : BoardState::open;
  changed_.notify_all();
}

BoardState Board::Impl::state() const {
  std::lock_guard lock(mutex_);
  return state_;
}

BoardAccount Board::Impl::account() const {
  std::lock_guard lock(mutex_);
  return audit_.account();
}

WireDamage Board::Impl::damage() const {
  std::lock_guard lock(mutex_);
  return damage_;
}

Event Board::Impl::next(HostTime deadline) {
  std::unique_lock lock(mutex_);
  if (!started_) throw IllegalBoardCall("next: the board was not started");
  if (state_ == BoardState::closed) throw IllegalBoardCall("next: the board is closed");
  std::optional<Event> event;
  changed_.wait_until(lock, deadline, [&] { return (event = ready_event()).has_value(); });
  return event ? std::move(*event) : Event(TimedOut{});
}

/// The event that next() returns now, if any.
std::optional<Event> Board::Impl::ready_event() {
  if (cancelled_) return Cancelled{};
  if (!queue_.empty()) {
    const bool was_full = queue_is_full();
    Event event = std::visit([](auto& queued) { return Event(std::move(queued)); }, queue_.front());
    queue_.pop_front();
    if (was_full) changed_.notify_all();
    return event;
  }
  if (open_gap_) return *std::exchange(open_gap_, std::nullopt);
  if (ending_ == Ending::end_of_stream) return end_of_stream_;
  if (ending_ == Ending::lost) return loss_;
  if (state_ != BoardState::running && state_ != BoardState::stopping) return Stopped{};
  return {};
}

}  // namespace wobblebench::hw
