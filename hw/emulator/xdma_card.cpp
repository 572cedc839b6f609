#include "hw/emulator/xdma_card.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <chrono>
#include <thread>

#include "base/hash.h"
#include "base/options.h"
#include "hw/wire/layout.h"

namespace wobblebench::hw {

std::size_t PacketFeed::pull(std::span<std::byte> to, HostTime deadline) {
  const ReadResult result = source_->read(to, deadline);
  lost_ = lost_ || result.status == ReadStatus::lost;
  // A source that has ended is emulated as a card that sends nothing.
  if (result.status == ReadStatus::end_of_stream) std::this_thread::sleep_until(deadline);
  return result.bytes;
}

bool PacketFeed::wait_for_packet(HostTime deadline) {
  if (bytes_left() > 0) return true;
  while (header_filled_ < kWireHeaderBytes) {
    const std::size_t count = pull(std::span(header_).subspan(header_filled_), deadline);
    if (count == 0) return false;
    header_filled_ += count;
  }
  const auto payload_bytes =
      wire_layout::get<std::uint32_t>(header_, wire_layout::kPayloadBytesOffset);
  payload_left_ = payload_bytes <= kWireMaxPayloadBytes ? payload_bytes : 0;
  header_filled_ = 0;
  header_taken_ = 0;
  has_header_ = true;
  ++packets_started_;
  return true;
}

std::size_t PacketFeed::take(std::span<std::byte> to, HostTime deadline) {
  if (header_left() > 0) {
    const auto from = std::span(header_).subspan(header_taken_);
    const std::size_t count = std::min(to.size(), from.size());
    std::copy_n(from.begin(), count, to.begin());
    header_taken_ += count;
    return count;
  }
  const std::size_t count = pull(to.first(std::min(to.size(), payload_left_)), deadline);
  payload_left_ -= count;
  return count;
}

namespace {

/// How often a waiting read checks whether it has to end.
constexpr auto kCardPollInterval = std::chrono::milliseconds(5);
/// Longest delay of the release of a closed file in the kernel.
constexpr auto kReleaseTimeout = std::chrono::seconds(1);

std::uint64_t hash(std::uint64_t seed, std::uint64_t index) {
  return mix64(seed + kGoldenGamma * (index + 1));
}

const XdmaEmulatorOptions& checked(const XdmaEmulatorOptions& options) {
  check_options(options);
  if (!std::has_single_bit(static_cast<unsigned>(options.alignment_bytes))) {
    throw InvalidOption(
        "alignment_bytes", std::to_string(options.alignment_bytes), "must be a power of two");
  }
  return options;
}

}  // namespace

/// A read in progress.
struct XdmaCard::Transfer {
  std::uint64_t handle;
  Opening& opening;
  std::span<std::byte> to;
  const std::function<bool()>& interrupted;
  HostTime deadline;
  std::size_t filled = 0;
};

XdmaCard::XdmaCard(LinkSource source, const XdmaEmulatorOptions& options)
    : source_(std::move(source)), options_(checked(options)) {}

int XdmaCard::open(bool end_of_packet, std::uint64_t& handle) {
  std::unique_lock lock(mutex_);
  if (current_handle_ != 0 && !release_follows_) return -EBUSY;
  changed_.wait_for(lock, kReleaseTimeout, [&] { return current_handle_ == 0; });
  if (!plugged_) return -ENODEV;
  if (current_handle_ != 0) return -EBUSY;
  std::unique_ptr<Link> source = source_();
  if (source == nullptr) return -EIO;
  handle = current_handle_ = ++last_handle_;
  release_follows_ = false;
  openings_[handle] = std::make_shared<Opening>(std::move(source), end_of_packet);
  return 0;
}

void XdmaCard::expect_release(std::uint64_t handle) {
  std::lock_guard lock(mutex_);
  if (current_handle_ == handle) release_follows_ = true;
}

void XdmaCard::release(std::uint64_t handle) {
  std::lock_guard lock(mutex_);
  openings_.erase(handle);
  if (current_handle_ == handle) current_handle_ = 0;
  changed_.notify_all();
}

std::shared_ptr<XdmaCard::Opening> XdmaCard::opening(std::uint64_t handle) const {
  std::lock_guard lock(mutex_);
  const auto found = openings_.find(handle);
  return current_handle_ == handle && found != openings_.end() ? found->second : nullptr;
}

std::ptrdiff_t XdmaCard::read(std::uint64_t handle,
                              std::span<std::byte> to,
                              const std::function<bool()>& interrupted) {
  const std::shared_ptr<Opening> open = opening(handle);
  if (open == nullptr) return -ENODEV;
  if (to.empty() || to.size() % static_cast<std::size_t>(options_.alignment_bytes) != 0)
    return -EINVAL;
  std::lock_guard one_at_a_time(open->transfer);
  ++open->reads;
  const auto timeout = std::chrono::duration_cast<HostClock::duration>(
      std::chrono::duration<double>(options_.timeout_s));
  Transfer transfer{handle, *open, to, interrupted, HostClock::now() + timeout};
  return run(transfer);
}

std::ptrdiff_t XdmaCard::run(Transfer& transfer) {
  for (;;) {
    const auto filled = static_cast<std::ptrdiff_t>(transfer.filled);
    if (transfer.interrupted()) return filled > 0 ? filled : -EINTR;
    const HostTime now = HostClock::now();
    const HostTime until = std::min(now + kCardPollInterval, transfer.deadline);
    const bool can_send = start_packet(transfer.opening);
    if (opening(transfer.handle) == nullptr) return -ENODEV;
    if (can_send && fill(transfer, until)) {
      return static_cast<std::ptrdiff_t>(transfer.filled);
    }
    if (transfer.opening.feed.lost()) unplug();
    if (now >= transfer.deadline) return transfer.filled > 0 ? filled : -ETIMEDOUT;
    if (!can_send) std::this_thread::sleep_until(until);
  }
}

bool XdmaCard::start_packet(Opening& opening) {
  if (opening.feed.bytes_left() == 0) {
    const std::int64_t packet = opening.feed.packets_started();
    if (packet == options_.unplug_at_packet) unplug();
    if (packet == options_.stall_at_packet && !std::exchange(opening.stalled_once, true)) {
      stall(true);
    }
  }
  return !is_stalled();
}

bool XdmaCard::reads_all_ones(const Opening& opening) const {
  return options_.all_ones_at_packet >= 0 && opening.feed.bytes_left() == 0 &&
         opening.feed.packets_started() >= options_.all_ones_at_packet;
}

/// Continues a transfer; true if it is complete.
bool XdmaCard::fill(Transfer& transfer, HostTime until) {
  Opening& open = transfer.opening;
  std::span<std::byte> room = transfer.to.subspan(transfer.filled);
  if (reads_all_ones(open)) {
    std::fill(room.begin(), room.end(), std::byte{0xFF});
    transfer.filled = transfer.to.size();
    return true;
  }
  if (!open.feed.wait_for_packet(until)) return false;
  if (options_.short_reads) {
    const std::size_t most = std::min(room.size(), open.feed.bytes_left());
    room = room.first(1 + hash(options_.seed, open.reads) % most);
  }
  const std::size_t count = open.feed.take(room, until);
  transfer.filled += count;
  const bool packet_ended = open.end_of_packet && open.feed.bytes_left() == 0;
  const bool cut_short = options_.short_reads && count > 0;
  return transfer.filled == transfer.to.size() || packet_ended || cut_short;
}

bool XdmaCard::is_plugged() const {
  std::lock_guard lock(mutex_);
  return plugged_;
}

void XdmaCard::unplug() {
  std::lock_guard lock(mutex_);
  plugged_ = false;
  current_handle_ = 0;
  changed_.notify_all();
}

void XdmaCard::replug() {
  std::lock_guard lock(mutex_);
  plugged_ = true;
}

bool XdmaCard::is_stalled() const {
  std::lock_guard lock(mutex_);
  return stalled_;
}

void XdmaCard::stall(bool stalled) {
  std::lock_guard lock(mutex_);
  stalled_ = stalled;
}

}  // namespace wobblebench::hw
