#include "hw/link/fault_link.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace wobblebench::hw {
namespace {

constexpr std::size_t kReadBytes = 65536;
constexpr std::uint64_t kShortestReads = 64;
constexpr std::uint64_t kFarthestReorder = 4;
constexpr std::uint64_t kMostFlips = 8;

void flip_bits(std::vector<std::byte>& bytes, const FaultPlan& plan, std::uint64_t packet) {
  const std::uint64_t flips = 1 + plan.draw(FaultKind::corrupt, packet, 1) % kMostFlips;
  for (std::uint64_t flip = 0; flip < flips; ++flip) {
    const std::uint64_t bit = plan.draw(FaultKind::corrupt, packet, 2 + flip) % (8 * bytes.size());
    bytes[bit / 8] ^= std::byte(1U << (bit % 8));
  }
}

}  // namespace

FaultLink::FaultLink(std::unique_ptr<Link> inner, FaultPlan plan, const HostTimeSource* time)
    : inner_(std::move(inner)), plan_(std::move(plan)), time_(time) {
  if (inner_ == nullptr) throw std::invalid_argument("faults need a link to strike");
}

void FaultLink::cancel() {
  waiting_.cancel();
  inner_->cancel();
}

void FaultLink::resume() {
  inner_->resume();
  waiting_.resume();
}

void FaultLink::close() {
  waiting_.close();
  inner_->close();
}

std::string FaultLink::loss() const {
  if (!unplugged_at_) return inner_->loss();
  return "the device is gone (a fault, at packet " + std::to_string(*unplugged_at_) + ")";
}

ReadResult FaultLink::read(std::span<std::byte> buffer, HostTime deadline) {
  for (;;) {
    if (const auto ended = waiting_.ended()) return {0, *ended};
    if (!passing_.empty()) {
      const HostTime ready = passing_.front().ready;
      if (ready <= now()) return {give(buffer), ReadStatus::ok};
      if (deadline <= now()) return {0, ReadStatus::timeout};
      waiting_.sleep_until(std::min(ready, deadline));
      continue;
    }
    if (ending_) return {0, *ending_};
    std::array<std::byte, kReadBytes> bytes;
    const ReadResult result = inner_->read(bytes, deadline);
    take(std::span(bytes).first(result.bytes));
    if (result.status == ReadStatus::end_of_stream || result.status == ReadStatus::lost) {
      framer_.finish();
      take({});
      if (!ending_) ending_ = result.status;
    } else if (result.status != ReadStatus::ok && passing_.empty()) {
      return result;
    }
  }
}

void FaultLink::take(std::span<const std::byte> bytes) {
  if (ending_) return;
  const bool at_end = bytes.empty();
  taken_.erase(taken_.begin(), taken_.begin() + static_cast<std::ptrdiff_t>(passed_));
  taken_start_ += std::exchange(passed_, 0);
  taken_.insert(taken_.end(), bytes.begin(), bytes.end());
  if (!at_end) framer_.feed(bytes);
  while (const auto frame = framer_.next()) {
    pass_damage(frame->offset);
    pass_packet(frame->bytes);
    if (ending_) return;
    passed_ += frame->bytes.size();
  }
  pass_damage(taken_start_ + taken_.size() - framer_.pending_bytes());
  if (at_end) release_held_back(true);
}

/// Bytes up to a place in the stream that belong to no packet.
void FaultLink::pass_damage(std::uint64_t until) {
  const auto damage = std::span(taken_).subspan(passed_, until - taken_start_ - passed_);
  if (damage.empty()) return;
  pass({damage.begin(), damage.end()});
  passed_ += damage.size();
}

void FaultLink::pass_packet(std::span<const std::byte> bytes) {
  const std::uint64_t packet = packets_++;
  const auto struck = [&](FaultKind kind) {
    if (!plan_.strikes(kind, packet)) return false;
    events_.push_back({kind, packet, packet_kind(bytes), packet_stamp(bytes).sequence});
    return true;
  };
  if (struck(FaultKind::unplug)) {
    release_held_back(true);
    ending_ = ReadStatus::lost;
    unplugged_at_ = packet;
    return;
  }
  if (struck(FaultKind::stall)) ready_ = now() + plan_.stall;
  if (struck(FaultKind::delay)) ready_ = std::max(ready_, now() + plan_.delay);
  in_short_reads_ = struck(FaultKind::short_reads);
  std::vector<std::byte> passed(bytes.begin(), bytes.end());
  if (struck(FaultKind::drop)) {
    passed.clear();
  } else {
    if (struck(FaultKind::corrupt)) flip_bits(passed, plan_, packet);
    if (struck(FaultKind::truncate)) {
      passed.resize(1 + plan_.draw(FaultKind::truncate, packet, 1) % (passed.size() - 1));
    }
    if (struck(FaultKind::duplicate)) pass(passed);
  }
  if (!passed.empty() && struck(FaultKind::reorder)) {
    const std::uint64_t later = 1 + plan_.draw(FaultKind::reorder, packet, 1) % kFarthestReorder;
    held_back_.push_back({std::move(passed), packet + later});
  } else if (!passed.empty()) {
    pass(std::move(passed));
  }
  release_held_back(false);
}

void FaultLink::release_held_back(bool all) {
  for (auto held = held_back_.begin(); held != held_back_.end();) {
    if (!all && held->until_packet >= packets_) {
      ++held;
      continue;
    }
    pass(std::move(held->bytes));
    held = held_back_.erase(held);
  }
}

void FaultLink::pass(std::vector<std::byte> bytes) {
  passing_.push_back({std::move(bytes), ready_, in_short_reads_});
}

std::size_t FaultLink::give(std::span<std::byte> buffer) {
  std::size_t given = 0;
  while (given < buffer.size() && !passing_.empty() && passing_.front().ready <= now()) {
    const Passing& front = passing_.front();
    std::size_t most = buffer.size() - given;
    if (front.in_short_reads) {
      most = std::min<std::size_t>(
          most, 1 + plan_.draw(FaultKind::short_reads, reads_++, 1) % kShortestReads);
    }
    const bool stop_here = front.in_short_reads;
    const std::size_t count = std::min(most, front.bytes.size() - given_);
    std::copy_n(front.bytes.begin() + static_cast<std::ptrdiff_t>(given_),
                count,
                buffer.begin() + static_cast<std::ptrdiff_t>(given));
    given += count;
    given_ += count;
    if (given_ == front.bytes.size()) {
      passing_.pop_front();
      given_ = 0;
    }
    if (stop_here) break;
  }
  return given;
}

}  // namespace wobblebench::hw
