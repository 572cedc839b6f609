// What can go wrong on a link, and when: written as "drop:0.01+corrupt@17+seed:7".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hw/probe/clock.h"

namespace wobblebench::hw {

enum class FaultKind {
  drop,         ///< the packet never comes
  duplicate,    ///< it comes twice
  corrupt,      ///< 1 to 8 of its bits are flipped
  truncate,     ///< its end is missing
  reorder,      ///< it comes 1 to 4 packets later
  delay,        ///< it and what follows comes `delay_ms` later
  stall,        ///< nothing comes for `stall_ms`
  unplug,       ///< the device is gone, instead of this packet
  short_reads,  ///< reads end after 1 to 64 bytes, from this packet to the next
};
inline constexpr int kFaultKinds = 9;

/// "drop", …, "short_reads".
std::string_view to_string(FaultKind kind);

struct Fault {
  FaultKind kind = FaultKind::drop;
  double rate = 0;                  ///< of all packets
  std::optional<std::uint64_t> at;  ///< this packet alone, counting all kinds from 0
};

struct FaultPlan {
  std::vector<Fault> faults;
  std::uint64_t seed = 1;
  HostClock::duration delay = std::chrono::milliseconds(5);
  HostClock::duration stall = std::chrono::milliseconds(300);

  /// Whether the fault strikes this packet: a function of seed, kind and packet alone.
  bool strikes(FaultKind kind, std::uint64_t packet) const;
  /// A number that depends on seed, kind, packet and `what` alone.
  std::uint64_t draw(FaultKind kind, std::uint64_t packet, std::uint64_t what) const;
};

/// Terms joined by '+': KIND:RATE (0 to 1), KIND@PACKET, seed:N, delay_ms:N, stall_ms:N (0 to
/// 60000). Throws InvalidOption "faults = TERM: what is allowed".
FaultPlan parse_faults(const std::string& text);

}  // namespace wobblebench::hw
