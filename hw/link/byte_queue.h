// A first-in, first-out queue of bytes with a fixed capacity.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace wobblebench::hw {

/// Ring buffer. Not thread-safe.
class ByteQueue {
 public:
  explicit ByteQueue(std::size_t capacity) : bytes_(capacity) {}

  std::size_t size() const { return size_; }
  std::size_t room() const { return bytes_.size() - size_; }

  /// `from` is not longer than room().
  void push(std::span<const std::byte> from) {
    while (!from.empty()) {
      const std::size_t at = (first_ + size_) % bytes_.size();
      const std::size_t count = std::min(from.size(), bytes_.size() - at);
      std::copy_n(from.begin(), count, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
      size_ += count;
      from = from.subspan(count);
    }
  }

  void push(std::size_t count, std::byte value) {
    for (; count > 0; --count) push(std::span(&value, 1));
  }

  /// Moves the oldest bytes to `to`; returns their number.
  std::size_t pop(std::span<std::byte> to) {
    std::size_t popped = 0;
    while (popped < to.size() && size_ > 0) {
      const std::size_t count = std::min({to.size() - popped, size_, bytes_.size() - first_});
      std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(first_),
                  count,
                  to.begin() + static_cast<std::ptrdiff_t>(popped));
      first_ = (first_ + count) % bytes_.size();
      size_ -= count;
      popped += count;
    }
    return popped;
  }

 private:
  std::vector<std::byte> bytes_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace wobblebench::hw
