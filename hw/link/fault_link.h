// Any link, with faults on the way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "hw/link/faults.h"
#include "hw/link/link.h"
#include "hw/link/waiting.h"
#include "hw/wire/packet_frame.h"

namespace wobblebench::hw {

/// A fault that struck.
struct FaultEvent {
  FaultKind kind = FaultKind::drop;
  std::uint64_t packet = 0;  ///< counting all kinds from 0
  PacketKind packet_kind = PacketKind::stick;
  std::uint64_t sequence = 0;  ///< of the packet
};

/// Strikes packets as they pass. Which, is a function of the plan's seed and the packet's number
/// alone, however the bytes are read. What the inner link damaged before passes as it is.
class FaultLink : public Link {
 public:
  /// `time` must outlive this; none: the host's clock.
  FaultLink(std::unique_ptr<Link> inner, FaultPlan plan, const HostTimeSource* time = nullptr);

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  LinkCapabilities capabilities() const override { return inner_->capabilities(); }
  std::string loss() const override;

  /// What struck so far, in order. To be called by the thread that reads.
  const std::vector<FaultEvent>& events() const { return events_; }

 private:
  struct Passing {
    std::vector<std::byte> bytes;
    HostTime ready;
    bool in_short_reads = false;
  };
  struct HeldBack {
    std::vector<std::byte> bytes;
    std::uint64_t until_packet;
  };

  HostTime now() const { return time_ ? time_->now() : HostClock::now(); }
  void take(std::span<const std::byte> bytes);
  void pass_packet(std::span<const std::byte> bytes);
  void pass(std::vector<std::byte> bytes);
  void pass_damage(std::uint64_t until);
  void release_held_back(bool all);
  std::size_t give(std::span<std::byte> buffer);

  const std::unique_ptr<Link> inner_;
  const FaultPlan plan_;
  const HostTimeSource* const time_;
  Waiting waiting_;
  PacketFramer framer_;
  std::vector<std::byte> taken_;   ///< from the inner link …
  std::uint64_t taken_start_ = 0;  ///< … whose first byte has this place in the stream …
  std::size_t passed_ = 0;         ///< … and of which so many were passed on
  std::deque<Passing> passing_;
  std::vector<HeldBack> held_back_;
  std::size_t given_ = 0;  ///< bytes of passing_.front()
  HostTime ready_{};       ///< of what is passed on next
  bool in_short_reads_ = false;
  std::uint64_t reads_ = 0;
  std::uint64_t packets_ = 0;
  std::vector<FaultEvent> events_;
  std::optional<ReadStatus> ending_;  ///< after all that is passing
  std::optional<std::uint64_t> unplugged_at_;
};

}  // namespace wobblebench::hw
