#include "tests/hw/support/memory_link.h"

#include <algorithm>

#include "tests/hw/support/streams.h"

namespace wobblebench::hw {

MemoryLink::MemoryLink(std::vector<std::byte> bytes, const MemoryLinkOptions& options)
    : options_(options), bytes_(std::move(bytes)) {}

ReadResult MemoryLink::read(std::span<std::byte> buffer, HostTime deadline) {
  std::unique_lock lock(mutex_);
  if (options_.ending == ReadStatus::timeout) {
    changed_.wait_until(
        lock, deadline, [&] { return cancelled_ || closed_ || read_ < bytes_.size(); });
  }
  if (closed_) return {0, ReadStatus::lost};
  if (cancelled_) return {0, ReadStatus::cancelled};
  if (read_ == bytes_.size()) return {0, options_.ending};
  std::size_t count = std::min(buffer.size(), bytes_.size() - read_);
  if (options_.chunk_seed != 0) {
    count = std::min<std::size_t>(count, 1 + hash(options_.chunk_seed, chunk_++) % 5000);
  }
  std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(read_), count, buffer.begin());
  read_ += count;
  return {count, ReadStatus::ok};
}

void MemoryLink::cancel() {
  std::lock_guard lock(mutex_);
  cancelled_ = true;
  changed_.notify_all();
}

void MemoryLink::resume() {
  std::lock_guard lock(mutex_);
  cancelled_ = false;
}

void MemoryLink::close() {
  std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

void MemoryLink::append(const std::vector<std::byte>& bytes) {
  std::lock_guard lock(mutex_);
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  changed_.notify_all();
}

LinkCapabilities MemoryLink::capabilities() const {
  LinkCapabilities capabilities;
  capabilities.origin = StreamOrigin::emulator;
  capabilities.waits_for_reader = options_.waits_for_reader;
  return capabilities;
}

}  // namespace wobblebench::hw
