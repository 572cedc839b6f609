#include "sim/card/card_model.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace wobblebench::sim {
namespace {

hw::DeviceDuration seconds(double value) {
  return hw::DeviceDuration(std::llround(value * 1e9));
}

}  // namespace

CardModel::CardModel(const CardOptions& options) : options_(options) {
  check_options(options);
  if (options.buffers_per_interrupt > options.buffers) {
    throw InvalidOption("buffers_per_interrupt",
                        std::to_string(options.buffers_per_interrupt),
                        "must be at most buffers = " + std::to_string(options.buffers));
  }
}

std::size_t CardModel::free_bytes() const {
  const auto size = static_cast<std::size_t>(options_.buffer_bytes);
  const std::size_t unused = static_cast<std::size_t>(options_.buffers) - ring_.size();
  return unused * size + (filling_ ? size - ring_.back().bytes.size() : 0);
}

void CardModel::push(std::span<const std::byte> packet, hw::DeviceTime time, bool ends_volume) {
  if (packet.size() > free_bytes()) {
    ++packets_dropped_;
  } else {
    const double transfer_s =
        static_cast<double>(packet.size()) / (options_.payload_rate_mb_s * 1e6);
    transfer_end_ = std::max(transfer_end_, time) + seconds(transfer_s);
    append(packet);
  }
  if (ends_volume) flush();
}

void CardModel::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (!filling_) {
      ring_.emplace_back();
      if (!free_.empty()) {
        ring_.back().bytes = std::move(free_.back());
        free_.pop_back();
        ring_.back().bytes.clear();
      }
      filling_ = true;
    }
    std::vector<std::byte>& buffer = ring_.back().bytes;
    const std::size_t room = static_cast<std::size_t>(options_.buffer_bytes) - buffer.size();
    const auto part = bytes.first(std::min(room, bytes.size()));
    buffer.insert(buffer.end(), part.begin(), part.end());
    bytes = bytes.subspan(part.size());
    if (part.size() == room) complete_buffer();
  }
}

void CardModel::complete_buffer() {
  filling_ = false;
  if (++pending_ == options_.buffers_per_interrupt) raise_interrupt();
}

void CardModel::raise_interrupt() {
  const hw::DeviceTime at = transfer_end_ + seconds(options_.interrupt_latency_s);
  for (auto buffer = ring_.end() - pending_; buffer != ring_.end(); ++buffer) {
    buffer->interrupt = at;
  }
  pending_ = 0;
}

void CardModel::flush() {
  if (filling_) {
    filling_ = false;
    ++pending_;
  }
  raise_interrupt();
}

std::optional<hw::DeviceTime> CardModel::next_interrupt() const {
  return ring_.empty() ? std::nullopt : ring_.front().interrupt;
}

bool CardModel::readable(hw::DeviceTime now) const {
  const auto at = next_interrupt();
  return at && *at <= now;
}

std::size_t CardModel::read(std::span<std::byte> buffer, hw::DeviceTime now) {
  std::size_t done = 0;
  while (done < buffer.size() && readable(now)) {
    Buffer& front = ring_.front();
    const std::size_t count = std::min(buffer.size() - done, front.bytes.size() - front.read);
    std::copy_n(front.bytes.begin() + static_cast<std::ptrdiff_t>(front.read),
                count,
                buffer.begin() + static_cast<std::ptrdiff_t>(done));
    done += count;
    front.read += count;
    if (front.read < front.bytes.size()) break;
    free_.push_back(std::move(front.bytes));
    ring_.pop_front();
  }
  return done;
}

}  // namespace wobblebench::sim
