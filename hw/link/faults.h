// Faults to inject into a link, as text: "drop:0.01+corrupt@17+seed:7".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace wobblebench::hw
