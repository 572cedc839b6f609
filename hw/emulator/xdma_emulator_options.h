// How a stand-in behaves.
#pragma once

#include <cstdint>

#include "base/options.h"
#include "base/units.h"

namespace wobblebench::hw {

/// Packets are counted from 0 at every opening of the node; −1: never.
struct XdmaEmulatorOptions {
  /// The length of a read is a multiple of it, bytes; a power of two.
  int alignment_bytes = 1;
  /// After it a read gives what it has, or ETIMEDOUT, s. The driver's default.
  double timeout_s = 10;
  bool short_reads = false;  ///< reads end early, at places that depend on the seed
  std::uint64_t seed = 1;
  int stall_at_packet = -1;     ///< nothing comes from here on, until stall(false)
  int unplug_at_packet = -1;    ///< the card is gone before it
  int all_ones_at_packet = -1;  ///< reads give 0xFF from here on
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
