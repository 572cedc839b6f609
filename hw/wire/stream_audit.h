// Checks the packets of a stream against its configuration and sequence numbers, and counts losses.
// The board, the recorder and the inspection of recordings use the same rules.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "hw/probe/polar_volume.h"
#include "hw/wire/account.h"
#include "hw/wire/configuration.h"
#include "hw/wire/packet.h"

namespace wobblebench::hw {

/// Classifies sticks by their sequence numbers, in the order of arrival: next, late, repeated or
/// missing. Keeps a BoardAccount of them. Not thread-safe.
class SequenceTracker {
 public:
  /// The stream says that stick `sequence` comes next. What is missing before it is counted as lost
  /// and returned; cause: corrupt if there was damage since the last call that advanced, else link.
  /// Throws UnreadableStream for more sticks than can be counted.
  std::optional<Gap> advance_to(std::uint64_t sequence, bool after_damage);

  /// True if the stick is the next one. If not, it is late or repeated and counted as such: one
  /// that is missing (in the last 1024 gaps) moves from its cause to out_of_order, any other is a
  /// duplicate. Call advance_to(sequence) first.
  [[nodiscard]] bool expects(std::uint64_t sequence);

  /// Counts the next stick as delivered, or as lost by `cause`.
  void deliver();
  Gap lose(LossCause cause);

  /// A new stream: sequence numbers start anew at the next advance_to(). Keeps the counts.
  void restart();

  /// The next stick; unset before any packet.
  std::optional<std::uint64_t> next() const { return next_; }

  const BoardAccount& account() const { return account_; }

 private:
  std::uint64_t& counter(LossCause cause);
  bool reclassify_missing(std::uint64_t sequence);
  void forget_old_gaps();

  struct Missing {
    std::uint64_t count;
    LossCause cause;
  };
  BoardAccount account_;
  std::optional<std::uint64_t> next_;
  std::map<std::uint64_t, Missing> missing_;  ///< recent gaps, by first sequence number
};

/// Result for one packet.
struct AuditResult {
  std::optional<Gap> missing;   ///< sticks lost before the packet
  std::optional<Gap> rejected;  ///< the packet's own stick, which cannot be delivered
  /// A configuration: it begins an acquisition. A stick: it is the next one; call deliver() or
  /// lose() before the next packet. A volume's end: it ends a volume of which a stick was emitted.
  bool accepted = false;
  /// Of the packet's number, index and sample count some are not the plan's. Of a configuration the
  /// plan is taken all the same.
  bool contradicts = false;
};

/// A configuration that names a stick further back than this begins a new acquisition; a nearer one
/// was late or repeated. No link delivers a packet more than 4 packets late.
inline constexpr std::uint64_t kMostLateSticks = 8;

/// Takes the packets of one stream in the order of arrival: of one acquisition, or of several one
/// after the other, each of which begins with a configuration that differs from the one before or
/// whose number lies behind the sticks that came. Not thread-safe.
class StreamAudit {
 public:
  /// The decoder skipped bytes: sticks found missing next are corrupt.
  void note_damage() { after_damage_ = true; }

  // Each throws UnreadableStream: "the device's configuration is not possible: …", or as
  // SequenceTracker::advance_to().
  AuditResult take(const ConfigurationPacket& packet);
  AuditResult take(const Stick& stick);
  AuditResult take(const VolumeEndPacket& packet);

  /// Counts the stick just accepted as delivered, or as lost by `cause`.
  void deliver() { tracker_.deliver(); }
  Gap lose(LossCause cause) { return tracker_.lose(cause); }

  const std::optional<Configuration>& configuration() const { return configuration_; }
  const BoardAccount& account() const { return tracker_.account(); }
  /// The number of the next stick; 0 before any packet.
  std::uint64_t next_sequence() const { return tracker_.next().value_or(0); }
  /// A stick was emitted since the last volume's end.
  bool inside_volume() const { return inside_volume_; }

 private:
  AuditResult contradiction();
  bool goes_back(std::uint64_t sequence) const;
  std::optional<Gap> advance_to(std::uint64_t sequence);

  SequenceTracker tracker_;
  std::optional<Configuration> configuration_;
  bool after_damage_ = false;  ///< since the sequence number last advanced
  bool inside_volume_ = false;
};

}  // namespace wobblebench::hw
