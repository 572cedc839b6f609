// Options and faults of the emulated card.
#pragma once

#include <cstdint>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::hw {

/// Packet indices start at 0 at every opening of the node; −1: never.
struct XdmaEmulatorOptions {
  /// Of the length of a read, bytes; a power of two.
  int alignment_bytes = 1;
  /// After this time a read returns what it has, or ETIMEDOUT, s. The driver's default.
  double timeout_s = 10;
  bool short_reads = false;  ///< reads end early, at random lengths (seed)
  std::uint64_t seed = 1;
  int stall_at_packet = -1;     ///< stalls before this packet, until stall(false)
  int unplug_at_packet = -1;    ///< unplugs before this packet
  int all_ones_at_packet = -1;  ///< reads give 0xFF from this packet on
};

template <OptionsOf<XdmaEmulatorOptions> O, class Visitor>
void describe(O& o, Visitor& v) {
  constexpr int kAnyPacket = 1'000'000'000;
  v.integer("alignment_bytes", o.alignment_bytes, 1, 4096);
  v.real("timeout_ms", o.timeout_s, kMillisecond, 1, 60000);
  v.flag("short_reads", o.short_reads);
  v.seed("seed", o.seed);
  v.integer("stall_at_packet", o.stall_at_packet, -1, kAnyPacket);
  v.integer("unplug_at_packet", o.unplug_at_packet, -1, kAnyPacket);
  v.integer("all_ones_at_packet", o.all_ones_at_packet, -1, kAnyPacket);
}

}  // namespace wobblebench::hw
