// What the packets of a stream prove about its sticks: which come next, which are missing, and why.
// The board, the recorder and the inspection of a recording count by the same rules.
#pragma once

#include <cstdint>
#include <optional>

#include "hw/probe/acquisition_plan.h"
#include "hw/probe/stick.h"
#include "hw/wire/account.h"
#include "hw/wire/packet.h"
#include "hw/wire/stream_origin.h"

namespace wobblebench::hw {

/// The plan that the following sticks belong to: once at the start, and when it changes.
struct Configuration {
  AcquisitionPlan plan;
  StreamOrigin source;  ///< what made the samples
};

/// What one packet showed.
struct Audited {
  std::optional<Gap> missing;  ///< sticks that the packet proves lost before it
  std::optional<Gap> refused;  ///< the packet's own stick, which cannot be delivered
  /// A configuration: it is new. A stick: it comes next; deliver() or lose() it before the next
  /// packet. A volume's end: it ends a volume of which a stick was emitted.
  bool accepted = false;
};

/// Takes the packets of one stream in the order in which they came. Not thread-safe.
class StreamAudit {
 public:
  /// The decoder passed over bytes: what is missing next is corrupt.
  void note_damage() { after_damage_ = true; }

  /// Throws std::runtime_error "the device's configuration is not possible: …".
  Audited take(const ConfigurationPacket& packet);
  Audited take(const Stick& stick);
  Audited take(const VolumeEndPacket& packet);

  /// The stick just accepted was put in its place, or lost by `cause`.
  void deliver() { ledger_.deliver(); }
  Gap lose(LossCause cause) { return ledger_.lose(cause); }

  const std::optional<Configuration>& configuration() const { return configuration_; }
  const BoardAccount& account() const { return ledger_.account(); }
  /// A stick was emitted since the last volume's end.
  bool inside_volume() const { return inside_volume_; }

 private:
  std::optional<Gap> advance_to(std::uint64_t sequence);

  SequenceLedger ledger_;
  std::optional<Configuration> configuration_;
  bool after_damage_ = false;  ///< since the stream last moved on
  bool inside_volume_ = false;
};

}  // namespace wobblebench::hw
