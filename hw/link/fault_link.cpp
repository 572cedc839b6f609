#include "hw/link/fault_link.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <deque>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/hash.h"
#include "base/options.h"
#include "hw/link/interruptible_wait.h"
#include "hw/wire/decoder.h"

namespace wobblebench::hw {

namespace {

constexpr std::array<std::string_view, kFaultKinds> kNames = {"drop",
                                                              "duplicate",
                                                              "corrupt",
                                                              "truncate",
                                                              "reorder",
                                                              "delay",
                                                              "stall",
                                                              "unplug",
                                                              "short_reads"};

constexpr double kLongestWaitMs = 60000;

[[noreturn]] void refuse(const std::string& term, const std::string& allowed) {
  throw InvalidOption("faults", term, allowed);
}

template <class T>
T number(const std::string& term, std::string_view text, T least, T most) {
  T value{};
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && rest == text.data() + text.size();
  if (whole && value >= least && value <= most) return value;
  std::ostringstream allowed;
  allowed << "must be a number within " << least << " and " << most;
  refuse(term, allowed.str());
}

HostClock::duration milliseconds(const std::string& term, std::string_view text) {
  const std::chrono::duration<double, std::milli> ms(number(term, text, 0.0, kLongestWaitMs));
  return std::chrono::duration_cast<HostClock::duration>(ms);
}

FaultKind kind_of(const std::string& term, std::string_view name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found != kNames.end()) return static_cast<FaultKind>(found - kNames.begin());
  std::string all;
  for (const auto& known : kNames) all += (all.empty() ? "" : ", ") + std::string(known);
  refuse(term,
         "must be KIND:RATE or KIND@PACKET with one of " + all +
             "; or seed:N, delay_ms:N, stall_ms:N");
}

void read_term(FaultPlan& plan, const std::string& term) {
  constexpr std::uint64_t kAny = ~std::uint64_t{0};
  const std::size_t sign = std::min(term.find_first_of(":@"), term.size());
  const std::string_view name = std::string_view(term).substr(0, sign);
  const std::string_view value = std::string_view(term).substr(std::min(sign + 1, term.size()));
  const bool at = sign < term.size() && term[sign] == '@';
  if (!at && name == "seed") {
    plan.seed = number<std::uint64_t>(term, value, 0, kAny);
  } else if (!at && name == "delay_ms") {
    plan.delay = milliseconds(term, value);
  } else if (!at && name == "stall_ms") {
    plan.stall = milliseconds(term, value);
  } else if (at) {
    plan.faults.push_back({kind_of(term, name), 0, number<std::uint64_t>(term, value, 0, kAny)});
  } else {
    plan.faults.push_back({kind_of(term, name), number(term, value, 0.0, 1.0), {}});
  }
}

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

std::string_view to_string(FaultKind kind) {
  return kNames.at(static_cast<std::size_t>(kind));
}

std::uint64_t FaultPlan::draw(FaultKind kind, std::uint64_t packet, std::uint64_t purpose) const {
  const auto stream = purpose * kFaultKinds + static_cast<std::uint64_t>(kind);
  return mix64(mix64(mix64(seed + kGoldenGamma) + stream + kGoldenGamma) + packet + kGoldenGamma);
}

bool FaultPlan::affects(FaultKind kind, std::uint64_t packet) const {
  return std::any_of(faults.begin(), faults.end(), [&](const Fault& fault) {
    if (fault.kind != kind) return false;
    if (fault.at) return *fault.at == packet;
    return unit_interval(draw(kind, packet, 0)) < fault.rate;
  });
}

FaultPlan parse_faults(const std::string& text) {
  FaultPlan plan;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('+', at), text.size());
    read_term(plan, text.substr(at, end - at));
    at = end + 1;
  }
  return plan;
}

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
