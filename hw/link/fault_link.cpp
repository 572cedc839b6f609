#include "hw/link/fault_link.h"

#include <algorithm>
#include <array>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "hw/link/interruptible_wait.h"
#include "hw/wire/packet_frame.h"

namespace wobblebench::hw {
namespace {

constexpr std::size_t kReadBytes = 65536;
constexpr std::uint64_t kLongestShortRead = 64;
constexpr std::uint64_t kLongestReorder = 4;
constexpr std::uint64_t kMostFlips = 8;

void flip_bits(std::vector<std::byte>& bytes, const FaultPlan& plan, std::uint64_t packet) {
  const std::uint64_t flips = 1 + plan.draw(FaultKind::corrupt, packet, 1) % kMostFlips;
  for (std::uint64_t flip = 0; flip < flips; ++flip) {
    const std::uint64_t bit = plan.draw(FaultKind::corrupt, packet, 2 + flip) % (8 * bytes.size());
    bytes[bit / 8] ^= std::byte(1U << (bit % 8));
  }
}

}  // namespace

class FaultLink::Impl {
 public:
  Impl(std::unique_ptr<Link> inner_link, FaultPlan plan, const HostTimeSource* time)
      : inner(std::move(inner_link)), plan_(std::move(plan)), time_(time) {
    if (inner == nullptr) throw std::invalid_argument("faults need a link to strike");
  }

  ReadResult read(std::span<std::byte> buffer, HostTime deadline);

  const std::unique_ptr<Link> inner;
  InterruptibleWait wait;
  std::vector<FaultEvent> events;
  std::optional<std::uint64_t> unplugged_at;  ///< index of the packet

 private:
  /// Bytes to deliver, not before `ready`.
  struct Chunk {
    std::vector<std::byte> bytes;
    HostTime ready;
    bool in_short_reads = false;
  };
  /// A packet to deliver after a later one.
  struct Reordered {
    std::vector<std::byte> bytes;
    std::uint64_t after_packet;
  };

  HostTime now() const { return time_ ? time_->now() : HostClock::now(); }
  void process(std::span<const std::byte> bytes);
  void forward_packet(std::span<const std::byte> bytes);
  void forward(std::vector<std::byte> bytes);
  void forward_damage(std::uint64_t until);
  void forward_reordered(bool all);
  std::size_t deliver(std::span<std::byte> buffer);

  const FaultPlan plan_;
  const HostTimeSource* const time_;
  PacketFramer framer_;
  std::vector<std::byte> received_;   ///< from the inner link
  std::uint64_t received_start_ = 0;  ///< offset of its first byte in the stream
  std::size_t forwarded_ = 0;         ///< bytes of received_ that are forwarded already
  std::deque<Chunk> outgoing_;
  std::size_t delivered_ = 0;  ///< bytes of outgoing_.front()
  std::vector<Reordered> reordered_;
  HostTime ready_{};  ///< of the next chunk
  bool in_short_reads_ = false;
  std::uint64_t reads_ = 0;
  std::uint64_t packets_ = 0;
  std::optional<ReadStatus> ending_;  ///< status after all outgoing chunks
};

FaultLink::FaultLink(std::unique_ptr<Link> inner, FaultPlan plan, const HostTimeSource* time)
    : impl_(std::make_unique<Impl>(std::move(inner), std::move(plan), time)) {}

FaultLink::~FaultLink() = default;

ReadResult FaultLink::read(std::span<std::byte> buffer, HostTime deadline) {
  return impl_->read(buffer, deadline);
}

void FaultLink::cancel() {
  impl_->wait.cancel();
  impl_->inner->cancel();
}

void FaultLink::resume() {
  impl_->inner->resume();
  impl_->wait.resume();
}

void FaultLink::close() {
  impl_->wait.close();
  impl_->inner->close();
}

LinkCapabilities FaultLink::capabilities() const {
  return impl_->inner->capabilities();
}

std::optional<HostTime> FaultLink::epoch() const {
  return impl_->inner->epoch();
}

std::string FaultLink::loss() const {
  if (!impl_->unplugged_at) return impl_->inner->loss();
  return "the device is gone (a fault, at packet " + std::to_string(*impl_->unplugged_at) + ")";
}

const std::vector<FaultEvent>& FaultLink::events() const {
  return impl_->events;
}

ReadResult FaultLink::Impl::read(std::span<std::byte> buffer, HostTime deadline) {
  for (;;) {
    if (const auto interrupted = wait.interrupted()) return {0, *interrupted};
    if (!outgoing_.empty()) {
      const HostTime ready = outgoing_.front().ready;
      if (ready <= now()) return {deliver(buffer), ReadStatus::ok};
      if (deadline <= now()) return {0, ReadStatus::timeout};
      wait.sleep_until(std::min(ready, deadline));
      continue;
    }
    if (ending_) return {0, *ending_};
    std::array<std::byte, kReadBytes> bytes;
    const ReadResult result = inner->read(bytes, deadline);
    process(std::span(bytes).first(result.bytes));
    if (result.status == ReadStatus::end_of_stream || result.status == ReadStatus::lost) {
      framer_.finish();
      process({});
      if (!ending_) ending_ = result.status;
    } else if (result.status != ReadStatus::ok && outgoing_.empty()) {
      return result;
    }
  }
}

/// No bytes: the end of the stream.
void FaultLink::Impl::process(std::span<const std::byte> bytes) {
  if (ending_) return;
  const bool at_end = bytes.empty();
  received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(forwarded_));
  received_start_ += std::exchange(forwarded_, 0);
  received_.insert(received_.end(), bytes.begin(), bytes.end());
  if (!at_end) framer_.feed(bytes);
  while (const auto frame = framer_.next()) {
    forward_damage(frame->offset);
    forward_packet(frame->bytes);
    if (ending_) return;
    forwarded_ += frame->bytes.size();
  }
  forward_damage(received_start_ + received_.size() - framer_.pending_bytes());
  if (at_end) forward_reordered(true);
}

/// Forwards the bytes up to a stream offset, which belong to no packet.
void FaultLink::Impl::forward_damage(std::uint64_t until) {
  const auto damage =
      std::span(received_).subspan(forwarded_, until - received_start_ - forwarded_);
  if (damage.empty()) return;
  forward({damage.begin(), damage.end()});
  forwarded_ += damage.size();
}

void FaultLink::Impl::forward_packet(std::span<const std::byte> bytes) {
  const std::uint64_t packet = packets_++;
  const auto inject = [&](FaultKind kind) {
    if (!plan_.affects(kind, packet)) return false;
    events.push_back({kind, packet, packet_kind(bytes), packet_stamp(bytes).sequence});
    return true;
  };
  if (inject(FaultKind::unplug)) {
    forward_reordered(true);
    ending_ = ReadStatus::lost;
    unplugged_at = packet;
    return;
  }
  if (inject(FaultKind::stall)) ready_ = now() + plan_.stall;
  if (inject(FaultKind::delay)) ready_ = std::max(ready_, now() + plan_.delay);
  in_short_reads_ = inject(FaultKind::short_reads);
  std::vector<std::byte> output(bytes.begin(), bytes.end());
  if (inject(FaultKind::drop)) {
    output.clear();
  } else {
    if (inject(FaultKind::corrupt)) flip_bits(output, plan_, packet);
    if (inject(FaultKind::truncate)) {
      output.resize(1 + plan_.draw(FaultKind::truncate, packet, 1) % (output.size() - 1));
    }
    if (inject(FaultKind::duplicate)) forward(output);
  }
  if (!output.empty() && inject(FaultKind::reorder)) {
    const std::uint64_t later = 1 + plan_.draw(FaultKind::reorder, packet, 1) % kLongestReorder;
    reordered_.push_back({std::move(output), packet + later});
  } else if (!output.empty()) {
    forward(std::move(output));
  }
  forward_reordered(false);
}

void FaultLink::Impl::forward_reordered(bool all) {
  for (auto held = reordered_.begin(); held != reordered_.end();) {
    if (!all && held->after_packet >= packets_) {
      ++held;
      continue;
    }
    forward(std::move(held->bytes));
    held = reordered_.erase(held);
  }
}

void FaultLink::Impl::forward(std::vector<std::byte> bytes) {
  outgoing_.push_back({std::move(bytes), ready_, in_short_reads_});
}

std::size_t FaultLink::Impl::deliver(std::span<std::byte> buffer) {
  std::size_t copied = 0;
  while (copied < buffer.size() && !outgoing_.empty() && outgoing_.front().ready <= now()) {
    const Chunk& front = outgoing_.front();
    std::size_t most = buffer.size() - copied;
    if (front.in_short_reads) {
      most = std::min<std::size_t>(
          most, 1 + plan_.draw(FaultKind::short_reads, reads_++, 1) % kLongestShortRead);
    }
    const bool end_read = front.in_short_reads;
    const std::size_t count = std::min(most, front.bytes.size() - delivered_);
    std::copy_n(front.bytes.begin() + static_cast<std::ptrdiff_t>(delivered_),
                count,
                buffer.begin() + static_cast<std::ptrdiff_t>(copied));
    copied += count;
    delivered_ += count;
    if (delivered_ == front.bytes.size()) {
      outgoing_.pop_front();
      delivered_ = 0;
    }
    if (end_read) break;
  }
  return copied;
}

}  // namespace wobblebench::hw
