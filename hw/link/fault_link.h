// Faults, as text "drop:0.01+corrupt@17+seed:7", and a link that injects them into the packets of
// another link.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hw/link/link.h"
#include "hw/probe/clock.h"

namespace wobblebench::hw {

enum class FaultKind {
  drop,         ///< the packet is omitted
  duplicate,    ///< sent twice
  corrupt,      ///< 1 to 8 of its bits are flipped
  truncate,     ///< its end is missing
  reorder,      ///< sent 1 to 4 packets later
  delay,        ///< it and all after it are sent `delay_ms` later
  stall,        ///< nothing is sent for `stall_ms`
  unplug,       ///< the device is lost before this packet
  short_reads,  ///< reads within this packet end after 1 to 64 bytes
};
inline constexpr int kFaultKinds = 9;

/// "drop", …, "short_reads".
std::string_view to_string(FaultKind kind);

struct Fault {
  FaultKind kind = FaultKind::drop;
  double rate = 0;                  ///< probability per packet
  std::optional<std::uint64_t> at;  ///< this packet only; all kinds counted from 0
};

struct FaultPlan {
  std::vector<Fault> faults;
  std::uint64_t seed = 1;
  HostClock::duration delay = std::chrono::milliseconds(5);
  HostClock::duration stall = std::chrono::milliseconds(300);

  /// Whether the packet has this fault; a function of seed, kind and packet only.
  bool affects(FaultKind kind, std::uint64_t packet) const;
  /// Uniform 64-bit hash of seed, kind, packet and `purpose`.
  std::uint64_t draw(FaultKind kind, std::uint64_t packet, std::uint64_t purpose) const;
};

/// Terms joined by '+': KIND:RATE (0 to 1), KIND@PACKET, seed:N, delay_ms:N, stall_ms:N (0 to
/// 60000). Throws InvalidOption "faults = TERM: ALLOWED".
FaultPlan parse_faults(const std::string& text);

enum class PacketKind : std::uint16_t;

/// An injected fault.
struct FaultEvent {
  FaultKind kind = FaultKind::drop;
  std::uint64_t packet = 0;  ///< index in the stream, all kinds counted from 0
  PacketKind packet_kind{};
  std::uint64_t sequence = 0;  ///< of the packet
};

/// Injects the faults of a plan. Which packets they affect depends on the plan's seed and the
/// packet's index only, not on the sizes of the reads. Damage of the inner link is passed on.
///
/// @code
/// #include "hw/recording/file_link.h"
/// auto file = std::make_unique<hw::FileLink>("scan.wbst");
/// hw::FaultLink link(std::move(file), hw::parse_faults("drop:0.01+unplug@5000+seed:7"));
/// std::vector<std::byte> buffer(65536);
/// while (link.read(buffer, hw::HostTime::max()).status == hw::ReadStatus::ok) {
/// }
/// for (const hw::FaultEvent& fault : link.events()) hw::to_string(fault.kind);
/// @endcode
class FaultLink : public Link {
 public:
  /// `time` must outlive this; null: the steady clock. Throws std::invalid_argument for a null
  /// link.
  FaultLink(std::unique_ptr<Link> inner, FaultPlan plan, const HostTimeSource* time = nullptr);
  ~FaultLink() override;

  ReadResult read(std::span<std::byte> buffer, HostTime deadline) override;
  void cancel() override;
  void resume() override;
  void close() override;
  LinkCapabilities capabilities() const override;
  std::optional<HostTime> epoch() const override;
  std::string loss() const override;

  /// The faults so far, in order. To be called by the reading thread.
  const std::vector<FaultEvent>& events() const;

 private:
  class Impl;

  const std::unique_ptr<Impl> impl_;
};

}  // namespace wobblebench::hw
