#include "hw/board/board.h"

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

}  // namespace wobblebench::hw
