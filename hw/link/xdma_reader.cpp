#include "hw/link/xdma_reader.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <utility>

namespace wobblebench::hw {

namespace {

/// About 0.4 s of the paper's stream.
constexpr std::size_t kQueueBytes = 4U << 20U;
constexpr std::size_t kLeastQueuedTransfers = 4;
/// After a read that returned nothing: avoids polling a million times a second.
constexpr auto kIdlePause = std::chrono::milliseconds(1);

/// A signal would interrupt the driver's wait, and with it the transfer.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

std::byte* aligned_bytes(std::size_t size, std::size_t alignment) {
  const std::size_t step = std::max(alignment, kPageBytes);
  auto* memory = static_cast<std::byte*>(std::aligned_alloc(step, (size + step - 1) / step * step));
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

FileDescriptor make_wake() {
  FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.is_open()) throw std::system_error(errno, std::generic_category(), "eventfd");
  return wake;
}

}  // namespace

XdmaReader::XdmaReader(XdmaNode node, std::string name, std::size_t transfer_bytes)
    : node_(std::move(node)),
      wake_(make_wake()),
      name_(std::move(name)),
      transfer_bytes_(transfer_bytes),
      queued_transfers_(std::max(kLeastQueuedTransfers, kQueueBytes / transfer_bytes)),
      transfer_(aligned_bytes(transfer_bytes, node_.alignment)),
      queue_(queued_transfers_ * transfer_bytes + kLongestValidOnes) {}

void XdmaReader::run() {
  block_signals();
  while (wait_for_room() && read_transfer()) {
  }
  node_.file.close();
  std::lock_guard lock(mutex_);
  node_closed_ = true;
  changed_.notify_all();
}

bool XdmaReader::wait_for_room() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock,
                [&] { return closed_ || queue_.room() >= transfer_bytes_ + kLongestValidOnes; });
  return !closed_;
}

bool XdmaReader::read_transfer() {
  if (node_.kind == XdmaNodeKind::fifo && !wait_for_fifo()) return true;
  const ssize_t count = ::read(node_.file.get(), transfer_.get(), transfer_bytes_);
  if (count < 0) return handle_error(errno);
  if (count > 0) return accept({transfer_.get(), static_cast<std::size_t>(count)});
  // 0 bytes: the end of a FIFO whose writers have closed it; an empty transfer of a card.
  if (node_.kind == XdmaNodeKind::fifo) return end(ReadStatus::end_of_stream, "");
  return pause_when_idle();
}

bool XdmaReader::wait_for_fifo() const {
  pollfd watched[] = {{node_.file.get(), POLLIN, 0}, {wake_.get(), POLLIN, 0}};
  // poll(2) reports nothing, not even POLLHUP, before the first writer opened the FIFO.
  return ::poll(watched, 2, -1) > 0 && watched[0].revents != 0;
}

bool XdmaReader::accept(std::span<const std::byte> transfer) {
  const DeviceGoneDetector::Result result = device_gone_.inspect(transfer);
  {
    std::lock_guard lock(mutex_);
    queue_.push(result.held_back, std::byte{0xFF});
    queue_.push(transfer.first(result.valid));
    changed_.notify_all();
  }
  return !result.gone || end(ReadStatus::lost, "reads all ones: the card has left the bus");
}

bool XdmaReader::pause_when_idle() {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kIdlePause, [&] { return closed_; });
  return true;
}

bool XdmaReader::handle_error(int error_number) {
  // After the driver's own timeout the next read starts the engine again.
  if (is_to_be_repeated(error_number) || error_number == EAGAIN) return pause_when_idle();
  return end(ReadStatus::lost, error_text(error_number));
}

bool XdmaReader::end(ReadStatus status, const std::string& reason) {
  const std::size_t held_back = status == ReadStatus::end_of_stream ? device_gone_.end() : 0;
  std::lock_guard lock(mutex_);
  queue_.push(held_back, std::byte{0xFF});
  ending_ = status;
  if (status == ReadStatus::lost) loss_ = name_ + ": " + reason;
  changed_.notify_all();
  return false;
}

ReadResult XdmaReader::read(std::span<std::byte> to, HostTime deadline) {
  std::unique_lock lock(mutex_);
  changed_.wait_until(lock, deadline, [&] {
    return closed_ || cancelled_ || queue_.size() > 0 || ending_ != ReadStatus::ok;
  });
  if (closed_) return {0, ReadStatus::lost};
  if (cancelled_) return {0, ReadStatus::cancelled};
  if (queue_.size() > 0) {
    const std::size_t count = queue_.pop(to);
    changed_.notify_all();
    return {count, ReadStatus::ok};
  }
  return {0, ending_ != ReadStatus::ok ? ending_ : ReadStatus::timeout};
}

void XdmaReader::cancel() {
  std::lock_guard lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

void XdmaReader::resume() {
  std::lock_guard lock(mutex_);
  cancelled_ = false;
}

void XdmaReader::close() {
  std::lock_guard lock(mutex_);
  closed_ = true;
  if (ending_ != ReadStatus::lost) loss_ = name_ + ": closed";
  changed_.notify_all();
  ::eventfd_write(wake_.get(), 1);
}

bool XdmaReader::wait_until_closed(HostTime deadline) {
  std::unique_lock lock(mutex_);
  return changed_.wait_until(lock, deadline, [&] { return node_closed_; });
}

std::string XdmaReader::loss() const {
  std::lock_guard lock(mutex_);
  return loss_;
}

DeviceGoneDetector::Result DeviceGoneDetector::inspect(std::span<const std::byte> transfer) {
  const auto is_other = [](std::byte value) { return value != std::byte{0xFF}; };
  const auto first = std::find_if(transfer.begin(), transfer.end(), is_other);
  const auto leading = static_cast<std::size_t>(first - transfer.begin());
  if (run_ + leading > kLongestValidOnes) return {.gone = true};
  if (first == transfer.end()) {
    run_ += leading;
    held_back_ += leading;
    return {};
  }
  const auto last = std::find_if(transfer.rbegin(), transfer.rend(), is_other);
  run_ = static_cast<std::size_t>(last - transfer.rbegin());
  const std::size_t released = std::exchange(held_back_, 0);
  const bool gone = run_ > kLongestValidOnes;
  return {released, transfer.size() - (gone ? run_ : 0), gone};
}

std::size_t DeviceGoneDetector::end() {
  return std::exchange(held_back_, 0);
}

}  // namespace wobblebench::hw
